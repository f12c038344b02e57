#pragma once

#include "base/scalar.h"

/// Tuned numbers of planes of the keyframe back end, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// Planes of the window.
namespace keyframe_planes {
inline constexpr int kMaxWeak = 6;    ///< keyframes in a row, before a plane without enough points is dissolved
inline constexpr Scalar kOff = 3;     ///< [plane.max_distance] of a point that leaves its plane
inline constexpr Scalar kReach2 = 4;  ///< [plane.max_distance^2] of a point that is put on a plane
}  // namespace keyframe_planes

}  // namespace pf::tuning
