#pragma once

#include "base/scalar.h"

/// Tuned numbers of the tables of the keyframe back end, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// Tables of the window.
namespace keyframe_map {
static constexpr int kKeyframes = 30;  ///< that are kept; the adjuster takes 32 poses, and one is the target's host
}  // namespace keyframe_map

/// Depths of the window's points.
namespace keyframe_depth {
inline constexpr Scalar kMinSin2 = Scalar(1e-8);  ///< of the angle between two rays that are not parallel
inline constexpr int kRounds = 3;                 ///< of Gauss-Newton
}  // namespace keyframe_depth

}  // namespace pf::tuning
