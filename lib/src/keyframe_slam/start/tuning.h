#pragma once

#include "base/scalar.h"

/// Tuned numbers of the keyframe back end's start, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// Assumptions of the window's start.
namespace keyframe_start {
inline constexpr Scalar kParallaxes = Scalar(4);        ///< of a match from the rotation that explains the picture best
inline constexpr Scalar kRotationSigma = Scalar(0.01);  ///< [rad] of that rotation
inline constexpr Scalar kPositionSigma = Scalar(0.1);   ///< [depths] while nothing is known of the position
inline constexpr Scalar kSpeedSigma = Scalar(0.2);      ///< [depths/s] of the speed from a record
inline constexpr int kPatience = 8;     ///< frames without a better solution that end a record at the next keyframe
inline constexpr int kSpeedFrames = 3;  ///< that give it
}  // namespace keyframe_start

/// A second pose from the caller, which fixes the scale.
namespace second_pose {
inline constexpr int kMaxSecondNs = 1000000;              ///< [ns] of a second pose from its frame, as files round
inline constexpr Scalar kMinSecondShift = Scalar(0.015);  ///< of a second pose from the first, in median depths
}  // namespace second_pose

}  // namespace pf::tuning
