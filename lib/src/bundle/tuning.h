#pragma once

#include "base/scalar.h"

/// Tuned numbers of the bundle adjuster and the first depths, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// Levenberg-Marquardt of the bundle adjuster.
namespace adjust {
inline constexpr Scalar kFirstDamping = Scalar(1e-3);  ///< relative, of the first round
inline constexpr Scalar kMinDamping = Scalar(1e-6);    ///< relative
inline constexpr Scalar kMaxDamping = Scalar(1e4);     ///< relative; more means that no step helps
inline constexpr Scalar kDampingDown = Scalar(5);      ///< divisor after a step that lowers the cost
inline constexpr Scalar kDampingUp = Scalar(8);        ///< factor after one that does not
inline constexpr Scalar kSmallGain = Scalar(1e-4);     ///< of the cost; a smaller one ends the adjustment
inline constexpr Scalar kNearlyDone = Scalar(4);       ///< times the bound on the gain; the next step is then the last
inline constexpr Scalar kRegularisation = Scalar(1e-9);  ///< on the diagonal of S [1/rad², 1/m²]
inline constexpr Scalar kMinInformation = Scalar(1);  ///< of an inverse depth; less is damped as if it were this [m²]
inline constexpr Scalar kNoInformation = Scalar(1e-12);  ///< the same; a point with less is left where it is [m²]
inline constexpr Scalar kMinPlaneRho = Scalar(1e-3);     ///< of a point that is held to its plane [1/m]
}  // namespace adjust

/// The start without a target.
namespace start {
inline constexpr int kMinFeatures = 12;                 ///< of frame 0 that are still seen
inline constexpr Scalar kMinParallax = Scalar(4);       ///< median in the last frame [standard deviations of a pixel]
inline constexpr Scalar kAmpleParallax = Scalar(15);    ///< the same; from here on the best explanation is taken
inline constexpr Scalar kSettledParallax = Scalar(30);  ///< the same; from here on the record ends
inline constexpr Scalar kGrowth = Scalar(1.4);          ///< of the parallax from one solution to the next
inline constexpr Scalar kMinMargin = Scalar(15);        ///< between the two best explanations [chi-square]
inline constexpr Scalar kSameDirection = Scalar(0.9);   ///< cosine between two motions that are one explanation
inline constexpr Scalar kMaxCost = Scalar(6);        ///< per pixel [squared standard deviations]; noise alone leaves 2
inline constexpr Scalar kPriorSigma = Scalar(0.7);   ///< of rho about 1: keeps what has no parallax finite
inline constexpr Scalar kBehindWeight = Scalar(10);  ///< of the prior, in addition, where rho < 0
inline constexpr Scalar kNoPixelPenalty = Scalar(100);     ///< of a seen feature that does not project [chi-square]
inline constexpr Scalar kHuber = Scalar(2);                ///< [standard deviations of a pixel]
inline constexpr Scalar kFirstRotationScale = Scalar(20);  ///< residual that counts half at first [px]
inline constexpr Scalar kMinGoodRho = Scalar(0.02);        ///< of a feature that is used, about a median of 1
inline constexpr Scalar kMaxGoodResidual = Scalar(5);  ///< the same, in every camera [standard deviations of a pixel]
inline constexpr Scalar kLensInflation = Scalar(8);    ///< frames whose matches have about the same error
inline constexpr int kGuessRounds = 25;                ///< of the adjustment from each direction of motion
inline constexpr int kRounds = 30;                     ///< of the adjustment of all cameras
inline constexpr int kPoseRounds = 8;                  ///< of a rotation or a pose alone
inline constexpr int kFollowRounds = 5;                ///< of the adjustment that a frame gets while depths are open
inline constexpr int kPoseTrials = 50;                 ///< sets of three features from which a frame's pose is sought
inline constexpr int kMinPoseInliers = 6;              ///< features that must agree with a frame's pose
inline constexpr int kPoseSeed = 1;                    ///< of the generator that draws these sets
inline constexpr Scalar kStepRegularisation = Scalar(1e-6);  ///< the same, on the diagonal [1/rad², 1/m²]
inline constexpr Scalar kMaxBaseline = Scalar(3);            ///< [median depths] sigma where pixels do not measure it
}  // namespace start

/// A camera that stands still while something moves before it. In 20 starts on four real sequences a moving camera leaves at most one
/// feature in six where it was by the time that anything has moved by kMovedPx.
namespace start_still {
inline constexpr Scalar kStillPx = Scalar(0.7);  ///< from where a feature was in the first frame
inline constexpr Scalar kMovedPx = Scalar(3);    ///< the same, of a feature that has moved
inline constexpr Scalar kTurnedPx = Scalar(2);   ///< of an estimated rotation
inline constexpr int kMinMoved = 3;              ///< features that have moved, or that are not in the record
inline constexpr int kShare = 3;                 ///< one of so many that are seen has not moved
inline constexpr int kMajority = 2;  ///< one of so many that are seen, where those that have not moved are most
inline constexpr int kColumns = 4;   ///< of cells that the picture is divided into
inline constexpr int kRows = 3;      ///< the same
inline constexpr int kMinCells = 4;  ///< that hold features which have not moved; of two rows, or it may be the horizon
}  // namespace start_still

/// The focal length from one image (zoom_fit.h).
namespace zoom_fit {
inline constexpr int kLeastPoints = 12;              ///< two for each unknown, but for one
inline constexpr int kRounds = 4;                    ///< of Gauss-Newton
inline constexpr Scalar kLeastShare = Scalar(1e-4);  ///< of the zoom's information, beside the pose; less is rounding
inline constexpr Scalar kMost = Scalar(1);           ///< log ratio; beyond it the rounds have left the picture
}  // namespace zoom_fit

}  // namespace pf::tuning
