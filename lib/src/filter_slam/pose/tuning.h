#pragma once

#include "base/scalar.h"

/// Tuned numbers of the pose of a frame in the filter back end, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// Matches that enter the update.
namespace pixel_update {
inline constexpr Scalar kOthersGate = Scalar(1.5);  ///< gates, of one match against all others: (1/100)^1.5 is 1/1000
inline constexpr int kMinOpen = 2;  ///< more than one in so many depths is open where pixels update the map alone
}  // namespace pixel_update

/// Groups of new features against the older ones.
namespace leave_one_out {
inline constexpr Scalar kGroupDeviations = Scalar(4);  ///< standard deviations of a normal variable: 1 in 30,000
inline constexpr int kYoung = 20;  ///< [frames] that a feature of such a group was measured in, fewer
}  // namespace leave_one_out

/// Three matches that fix a pose.
namespace triple_consensus {
inline constexpr Scalar kGateOfThree = Scalar(22.5);  ///< chi-square of six degrees of freedom, 0.999
}  // namespace triple_consensus

}  // namespace pf::tuning
