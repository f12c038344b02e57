#pragma once

#include "base/scalar.h"

/// Tuned numbers of the keyframe back end's start, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// A second pose that the caller says, from which the scale follows.
namespace second_pose {
inline constexpr int kMaxSecondNs = 1000000;              ///< [ns] of a second pose from its frame, as files round
inline constexpr Scalar kMinSecondShift = Scalar(0.015);  ///< of a second pose from the first, in median depths
}  // namespace second_pose

}  // namespace pf::tuning
