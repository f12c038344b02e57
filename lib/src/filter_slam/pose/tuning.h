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

/// The inertial unit's noise, learned. A frame's innovation over its expectation is a likelihood's slope in the log of the variance.
namespace unit_noise {
inline constexpr Scalar kLeast = Scalar(0.3333);    ///< of a density to the stated one
inline constexpr Scalar kMost = Scalar(10);         ///< the same, at most
inline constexpr int kMaxGap = 4;                   ///< median intervals that three samples in a row span, at most
inline constexpr int kWindow = 100;                 ///< samples of which differences are averaged
inline constexpr Scalar kWhite = Scalar(0.7);       ///< of third to second differences, each over that of white noise
inline constexpr Scalar kGain = Scalar(0.3);        ///< of the mean over windows
inline constexpr Scalar kStep = Scalar(4);          ///< change of the variance's factor by a window, at most
inline constexpr Scalar kRate = Scalar(0.1);        ///< step of the log variance per frame
inline constexpr Scalar kSlack = Scalar(1.3);       ///< mean share above which innovations are not explained
inline constexpr Scalar kMostOfFrame = Scalar(5);   ///< nis / dof of one frame, at most
inline constexpr Scalar kNearBound = Scalar(0.95);  ///< of kMost: no noise explains it
}  // namespace unit_noise

}  // namespace pf::tuning
