#pragma once

#include "base/scalar.h"

/// Tuned numbers of the window: what each one means and its unit. tools/sweep-tuning halves and doubles them; what no
/// sweep has measured has no figure here.

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
inline constexpr Scalar kNoInformation = Scalar(1e-12);  ///< likewise; a point with less is left where it is [m²]
inline constexpr Scalar kMinPlaneRho = Scalar(1e-3);     ///< of a point that is held to its plane [1/m]
}  // namespace adjust

/// The start without a target.
namespace start {
inline constexpr int kMinFeatures = 12;                 ///< of frame 0 that are still seen
inline constexpr Scalar kMinParallax = Scalar(4);       ///< median in the last frame [standard deviations of a pixel]
inline constexpr Scalar kAmpleParallax = Scalar(15);    ///< likewise; from here on the best explanation is taken
inline constexpr Scalar kSettledParallax = Scalar(30);  ///< likewise; from here on the record ends
inline constexpr Scalar kGrowth = Scalar(1.4);          ///< of the parallax from one solution to the next
inline constexpr Scalar kMinMargin = Scalar(15);        ///< between the two best explanations [chi-square]
inline constexpr Scalar kSameDirection = Scalar(0.9);   ///< cosine between two motions that are one explanation
inline constexpr Scalar kMaxCost = Scalar(6);        ///< per pixel [squared standard deviations]; noise alone leaves 2
inline constexpr Scalar kPriorSigma = Scalar(0.7);   ///< of rho about 1: keeps what has no parallax finite
inline constexpr Scalar kBehindWeight = Scalar(10);  ///< of the prior, in addition, where rho < 0
inline constexpr Scalar kNoPixelPenalty = Scalar(100);     ///< of a seen feature that does not project [chi-square]
inline constexpr Scalar kHuber = Scalar(2);                ///< [standard deviations of a pixel]
inline constexpr Scalar kFirstRotationScale = Scalar(20);  ///< residual that counts half at first [px]
inline constexpr Scalar kMinGoodRho = Scalar(0.02);        ///< of a feature that is trusted, about a median of 1
inline constexpr Scalar kMaxGoodResidual = Scalar(5);  ///< likewise, in every camera [standard deviations of a pixel]
inline constexpr Scalar kLensInflation = Scalar(8);    ///< frames whose matches have about the same error
inline constexpr int kGuessRounds = 25;                ///< of the adjustment from each direction of motion
inline constexpr int kRounds = 30;                     ///< of the adjustment of all cameras
inline constexpr int kPoseRounds = 8;                  ///< of a rotation or a pose alone
inline constexpr int kFollowRounds = 5;                ///< of the adjustment that a frame gets while depths are open
inline constexpr int kPoseTrials = 50;                 ///< sets of three features from which a frame's pose is sought
inline constexpr int kMinPoseInliers = 6;              ///< features that must agree with a frame's pose
inline constexpr int kPoseSeed = 1;                    ///< of the generator that draws these sets
inline constexpr Scalar kStepRegularisation = Scalar(1e-6);  ///< likewise, on the diagonal [1/rad², 1/m²]
inline constexpr Scalar kMaxBaseline = Scalar(3);            ///< [median depths] sigma where pixels tell nothing of it
}  // namespace start

/// A camera that stands still while something moves before it. In 20 starts on four real sequences a moving camera leaves at most one
/// feature in six where it was by the time that anything has moved by kMovedPx.
namespace start_still {
inline constexpr Scalar kStillPx = Scalar(0.7);  ///< from where a feature was in the first frame
inline constexpr Scalar kMovedPx = Scalar(3);    ///< likewise, of a feature that has moved
inline constexpr Scalar kTurnedPx = Scalar(2);   ///< of an estimated rotation
inline constexpr int kMinMoved = 3;              ///< features that have moved, or that are not in the record
inline constexpr int kShare = 3;                 ///< one of so many that are seen has not moved
inline constexpr int kColumns = 4;               ///< of cells that the picture is divided into
inline constexpr int kRows = 3;                  ///< likewise
inline constexpr int kMinCells = 4;  ///< that hold features which have not moved; of two rows, or it may be the horizon
}  // namespace start_still

/// Tables of the window.
namespace window_map {
inline constexpr int kKeyframes = 30;  ///< that are kept; the adjuster takes 32 poses, and one is the target's host
}  // namespace window_map

/// Depths of the window's points.
namespace window_depth {
inline constexpr Scalar kMinSin2 = Scalar(1e-8);  ///< of the angle between two rays that are not parallel
inline constexpr int kRounds = 3;                 ///< of Gauss-Newton
}  // namespace window_depth

/// Prediction of the window's body.
namespace window_motion {
inline constexpr Scalar kGrowth = Scalar(2e-6);  ///< of a variance in float, by prediction
}  // namespace window_motion

/// Pose of a frame of the window.
namespace window_pose {
inline constexpr int kSeed = 1;                       ///< of the generator that draws triples
inline constexpr int kTrials = 100;                   ///< triples, at most
inline constexpr int kRefinementRounds = 6;           ///< of the consensus
inline constexpr Scalar kBoundSigmas = Scalar(3);     ///< of a match that make the bound of an inlier
inline constexpr Scalar kHuber = Scalar(2);           ///< residuals beyond count linearly [standard deviations]
inline constexpr int kRounds = 5;                     ///< of Gauss-Newton with each match's own noise
inline constexpr Scalar kSmallStep2 = Scalar(1e-12);  ///< [rad^2, m^2] squared step that ends the fit
}  // namespace window_pose

/// A frame of the window.
namespace window_tracking {
inline constexpr Scalar kMapSigma = Scalar(1);           ///< [px] of a point of the map beside its depth, in a search
inline constexpr Scalar kBoundWidth = Scalar(0.004);     ///< of a match that supports a pose, in image widths
inline constexpr Scalar kBoundSigmas = Scalar(4);        ///< likewise, in standard deviations of a match
inline constexpr int kScouts = 30;                       ///< candidates that are measured first in wide ellipses
inline constexpr Scalar kWideEllipse = Scalar(12);       ///< [px] largest semi-axis of those
inline constexpr Scalar kTemplateEllipse = Scalar(4.5);  ///< [px] largest semi-axis in which templates are tried
inline constexpr int kRowPasses = 2;                     ///< of consensus with velocities that its pose tells
inline constexpr int kYoung = 16;                        ///< points with a depth, below which the others help
inline constexpr Scalar kOpenSpread = Scalar(2);         ///< of an inverse depth not known yet, in the median one
inline constexpr Scalar kWeakPrior = Scalar(1);          ///< weight of the prediction where matches leave a pose open
inline constexpr Scalar kMaxParallel = Scalar(0.0087);  ///< [rad] between rays that need no depth to fit: half a degree
}  // namespace window_tracking

/// Keyframes and triangulation.
namespace window_slam {
inline constexpr Scalar kMinParallax = Scalar(0.0349);      ///< [rad] 2 degrees, Masoud 2015
inline constexpr Scalar kKeyframeShift = Scalar(0.06);      ///< since the last keyframe, in median depths
inline constexpr Scalar kKeyframeTurn = Scalar(0.15);       ///< likewise [rad]
inline constexpr int kMaxSecondNs = 1000000;                ///< [ns] of a second pose from its frame, as files round
inline constexpr Scalar kMinSecondShift = Scalar(0.015);    ///< of a second pose from the first, in median depths
inline constexpr Scalar kFewPoints = Scalar(0.6);           ///< of map.features_in_view
inline constexpr Scalar kMinKeyframeShift = Scalar(0.015);  ///< of a keyframe that comes for few points
inline constexpr Scalar kMinKeyframeTurn = Scalar(0.04);    ///< likewise [rad]
}  // namespace window_slam

/// The adjustment of keyframes.
namespace window_adjustment {
inline constexpr int kMinPoints = 8;          ///< that an adjustment needs
inline constexpr int kMinShared = 8;          ///< points that a fixed keyframe shares with the free ones
inline constexpr int kRounds = 10;            ///< of Levenberg-Marquardt
inline constexpr int kFirstRounds = 30;       ///< likewise, while the window holds all keyframes
inline constexpr int kMinPlanePoints = 4;     ///< of a plane that is adjusted
inline constexpr int kMinScaleKeyframes = 2;  ///< held fixed, so that distances from planes do not shrink the map
inline constexpr int kMinConnected = 3;   ///< keyframes that are adjusted without those that they share no points with
inline constexpr int kHeldKeyframes = 3;  ///< the oldest, where all others are adjusted
inline constexpr int kHeldAway = 6;       ///< likewise, where the first keyframe of the map is not among them
inline constexpr Scalar kHeldDistance = Scalar(1e-3);   ///< of a distance that holds the scale: its sigma
inline constexpr int kMinTargetPoints = 4;              ///< of the target, that hold a keyframe
inline constexpr Scalar kHuber = Scalar(2);             ///< residuals beyond count linearly [standard deviations]
inline constexpr Scalar kMinSigma = Scalar(0.25);       ///< [px] of a pixel, at least
inline constexpr Scalar kOutlierSigmas = Scalar(5);     ///< of a pixel that is forgotten afterwards
inline constexpr Scalar kPriorSigma = Scalar(10);       ///< of the prior on inverse depths, in their mean
inline constexpr Scalar kBehindWeight = Scalar(1e4);    ///< of the prior in addition, where a point is behind its host
inline constexpr Scalar kNoPixelPenalty = Scalar(100);  ///< of a seen point that does not project [chi-square]
inline constexpr Scalar kTargetSigma = Scalar(1e-4);    ///< of the distance of a target's point, in distances, at least
}  // namespace window_adjustment

/// Planes of the window.
namespace window_planes {
inline constexpr int kMaxWeak = 6;  ///< keyframes in a row, before a plane without enough points is dissolved
}  // namespace window_planes

/// What a start of the window assumes.
namespace window_start {
inline constexpr Scalar kParallaxes = Scalar(4);        ///< of a match from the rotation that explains the picture best
inline constexpr Scalar kRotationSigma = Scalar(0.01);  ///< [rad] of that rotation
inline constexpr Scalar kPositionSigma = Scalar(0.1);   ///< [depths] while nothing is known of the position
inline constexpr Scalar kSpeedSigma = Scalar(0.2);      ///< [depths/s] of the speed that a record tells
inline constexpr int kPatience = 8;     ///< frames without a better solution that end a record at the next keyframe
inline constexpr int kSpeedFrames = 3;  ///< that tell it
}  // namespace window_start

}  // namespace pf::tuning
