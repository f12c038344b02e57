#pragma once

#include "base/scalar.h"

/// Tuned numbers of the keyframe back end, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// Keyframes and triangulation.
namespace keyframe_slam {
inline constexpr Scalar kMinParallax = Scalar(0.0349);      ///< [rad] 2 degrees, Masoud 2015
inline constexpr Scalar kKeyframeShift = Scalar(0.06);      ///< since the last keyframe, in median depths
inline constexpr Scalar kKeyframeTurn = Scalar(0.15);       ///< the same of the rotation [rad]
inline constexpr Scalar kFewPoints = Scalar(0.6);           ///< of map.features_in_view
inline constexpr Scalar kMinKeyframeShift = Scalar(0.015);  ///< of a keyframe that comes for few points
inline constexpr Scalar kMinKeyframeTurn = Scalar(0.04);    ///< the same of the rotation [rad]
}  // namespace keyframe_slam

}  // namespace pf::tuning
