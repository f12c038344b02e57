#pragma once

#include "base/scalar.h"

/// Tuned numbers of what both back ends share, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// A frame while tracking.
namespace tracking {
inline constexpr int kMinInliers = 8;       ///< of a tracked frame, or half of map.features_in_view if that is less
inline constexpr int kMinInliersOfFew = 5;  ///< and never fewer than that
inline constexpr Scalar kMaxLensDeviation = Scalar(3);  ///< prior sigmas of an estimated lens without a warning
}  // namespace tracking

/// Whether a pose can be used.
namespace usable_pose {
inline constexpr Scalar kMaxRotationSigma = Scalar(0.349);  ///< [rad] 20 degrees
inline constexpr Scalar kMaxPositionSigma = Scalar(0.5);    ///< in median depths
}  // namespace usable_pose

/// Finding the map again.
namespace relocaliser {
inline constexpr int kTriples = 40;                  ///< of matches, each of which may fix the pose
inline constexpr Scalar kNearbySigma = Scalar(0.1);  ///< [rad] rotation sigma of a prediction that is searched linearly
inline constexpr Scalar kMaxDepthSigma = Scalar(0.3);  ///< relative sigma of an inverse depth that may place the camera
inline constexpr Scalar kProposalPixels = Scalar(0.004);  ///< sigma of a match against the map, in image widths
inline constexpr float kMinRecognition = 0.5f;            ///< correlation of a kept view that is searched about
inline constexpr Scalar kAboutView = Scalar(0.1);         ///< sigma of the pose about a kept view [rad], and in depths
inline constexpr Scalar kAboutProposal = Scalar(0.03);    ///< the same about the last frame's proposal
inline constexpr Scalar kMapSigma = Scalar(2);            ///< [px] of a point of the map in a search about such a pose
inline constexpr Scalar kProposalRotation = Scalar(0.035);  ///< [rad] between two proposals, on top of the motion
inline constexpr Scalar kProposalShift = Scalar(0.05);      ///< the same, in depths
inline constexpr Scalar kMotionGate = Scalar(3);            ///< sigmas of the velocities
inline constexpr Scalar kMaxRateSigma = Scalar(1);          ///< [rad/s] of a hand
inline constexpr Scalar kMaxSpeedSigma = Scalar(0.5);       ///< [depths/s] of a hand
}  // namespace relocaliser

/// Bounds of the prediction of a body without measurements.
namespace body_motion {
inline constexpr Scalar kSpeedDecay = Scalar(0.25);       ///< [s] time constant of a speed that is not measured
inline constexpr Scalar kMaxRotationSigma = Scalar(0.5);  ///< [rad] of an axis; beyond, angular noise is left out
inline constexpr Scalar kMaxSpeedSigma = Scalar(1);       ///< [m/s] of an axis; beyond, linear noise is left out
inline constexpr Scalar kAnyRotation = Scalar(1.8);       ///< [rad] uniform over a full rotation: the most that grows
inline constexpr Scalar kAnyPosition = Scalar(100);       ///< [m] the same
inline constexpr Scalar kLeastSpeedSigma = Scalar(1e-3);  ///< [m/s, rad/s] of an axis whose speed has decayed
inline constexpr Scalar kAcceleration = Scalar(1);        ///< [m/s^2] prior sigma of a hand's acceleration
}  // namespace body_motion

/// The depth of new features.
namespace feature_keeper {
inline constexpr int kMinDepths = 8;            ///< for a median
inline constexpr Scalar kBehindTarget = 2;      ///< assumed depth of the scene, in depths of the target
inline constexpr Scalar kSureSign = Scalar(9);  ///< chi-square of an inverse depth, above which its sign is certain
}  // namespace feature_keeper

/// New features.
namespace image_corners {
inline constexpr int kCornerThreshold = 8;       ///< [grey levels] of the segment test
inline constexpr float kMinCornerScore = 12.0f;  ///< smaller eigenvalue of the gradients [grey levels^2/px^2]
inline constexpr int kFaintThreshold = 3;        ///< [grey levels] the same, where such corners leave too few in view
inline constexpr float kFaintScore = 1.5f;       ///< the same
inline constexpr int kFaintBelow = 2;            ///< tracked frames' least inliers in view, below which it is that
inline constexpr int kMinNewFeatures = 4;        ///< in one frame; new features share an anchor
inline constexpr int kMaxInCell = 3;             ///< features in a cell of the image; one more where it shows a plane
inline constexpr int kPlaneAhead = 2;  ///< features that do not count there when the emptiest cells are chosen
}  // namespace image_corners

/// The order in which features are searched.
namespace image_front_end {
inline constexpr float kIncomparable = 1000;  ///< subtracted from the rate of incomparable features: more than any rate
inline constexpr int kScouts = 12;            ///< candidates that are measured first when the pose is uncertain
inline constexpr Scalar kWideEllipse = Scalar(6);  ///< [px] largest semi-axis above which scouts are measured first
inline constexpr int kMinConsensus = 5;            ///< inliers that a consensus needs during a start
inline constexpr int kSettled = 5;     ///< measurements of a feature whose residuals are those of its matches
inline constexpr int kMinWide = 2;     ///< one in so many ellipses is wide where searches follow the image
inline constexpr int kFewPassing = 2;  ///< matches for each that passes a gate, above which chance lets those pass
}  // namespace image_front_end

/// Features that are fixed to the image (FixedFeatures).
namespace fixed_features {
inline constexpr int kMaxAge = 90;             ///< [frames] of a reference while the image stands still
inline constexpr Scalar kMinFlow = Scalar(2);  ///< [px] by which a feature has moved
inline constexpr int kMinMoved = 2;   ///< one in so many features has moved, and as one, where others are judged
inline constexpr int kMinPixels = 8;  ///< of them
inline constexpr int kRounds = 3;     ///< of the fit of a rotation
inline constexpr Scalar kRegularisation = Scalar(1e-3);  ///< [px^2/rad^2] of that fit
inline constexpr Scalar kStill = Scalar(0.25);           ///< [px] sigma of the shift of a fixed feature
inline constexpr Scalar kParallax = Scalar(0.7);  ///< sigma of the scene's shift, in that of the image as a whole
inline constexpr Scalar kMaxStep = Scalar(4);     ///< log-odds of one comparison, at most
inline constexpr Scalar kMost = Scalar(12);    ///< log-odds of all comparisons, at most: three in favour undo any past
inline constexpr Scalar kScene = Scalar(50);   ///< features of the scene for each fixed one, before any was judged
inline constexpr Scalar kFixed = Scalar(6.2);  ///< log-odds from which a feature is masked: wrong in 0.2 %
inline constexpr int kMargin = 16;             ///< [px] about such a feature
inline constexpr int kDiscredits = 2;          ///< one in so many inliers, from which the map comes from what is fixed
}  // namespace fixed_features

/// Where the picture as a whole has gone.
namespace followed_view {
inline constexpr Scalar kSigma = Scalar(0.3);   ///< [px of a thumbnail], for a translation counts as a rotation
inline constexpr Scalar kWideArea = Scalar(4);  ///< least area of a wide ellipse in those about followed pixels
}  // namespace followed_view

/// The noise of matches in images (lib/docs/theory/noise.md).
namespace noise {
inline constexpr Scalar kReferenceSigma = Scalar(0.25);  ///< [px] of the first view, which later ones are compared with
inline constexpr Scalar kSearchSigma = Scalar(0.6);      ///< [px] of a match before its template's fit
inline constexpr Scalar kPriorFrames = Scalar(8);        ///< tau before anything has been seen
inline constexpr Scalar kPriorPairs = Scalar(300);       ///< that the prior of tau is worth, in pairs of residuals
inline constexpr Scalar kMinFrames = Scalar(1);          ///< of tau
inline constexpr Scalar kMaxFrames = Scalar(30);         ///< of tau
inline constexpr Scalar kMemory = Scalar(0.9375);        ///< lambda of a feature's running mean, per frame
inline constexpr Scalar kFade = Scalar(0.995);           ///< of the pooled sums, per frame
inline constexpr Scalar kGain = Scalar(0.05);            ///< of the scale, per frame with kEnough matches
inline constexpr Scalar kEnough = Scalar(20);            ///< matches
inline constexpr Scalar kClip = Scalar(4);               ///< of a square whose mean is one
inline constexpr Scalar kMinScale = Scalar(1);           ///< g; the prior: a constant error does not show in residuals
inline constexpr Scalar kMaxScale = Scalar(10);          ///< g
inline constexpr Scalar kMaxPlausible = Scalar(3);       ///< g, beyond which noise alone cannot be the reason
inline constexpr Scalar kMaxLeverage = Scalar(0.5);      ///< of a match that is learnt from
inline constexpr Scalar kMaxResidual = Scalar(3);        ///< [sigma] per axis, in correlations
}  // namespace noise

/// Points of planes.
namespace plane_keeper {
inline constexpr int kConverged = 10;               ///< observations before a point may be folded
inline constexpr int kDiscoverEvery = 5;            ///< frames
inline constexpr int kMaxRejections = 4;            ///< in a row, before a folded point is unfolded
inline constexpr int kTrialRejections = 2;          ///< in a row, before it is dropped
inline constexpr int kMinFixed = 4;                 ///< points that a point group needs
inline constexpr Scalar kReach = Scalar(0.5);       ///< beyond the outline of a plane, in square roots of its area
inline constexpr Scalar kUnfoldSigma = Scalar(10);  ///< of an unfolded point along the normal, in plane.max_distance
}  // namespace plane_keeper

/// Whole planes.
namespace plane_lifecycle {
inline constexpr int kMinPoints = 4;               ///< of a plane that once had more than plane.min_points
inline constexpr int kMaxWeakFrames = 60;          ///< in a row, before a plane without enough points is dissolved
inline constexpr Scalar kMaxSlant = Scalar(0.05);  ///< of a plane against its frame, above which it gets another frame
inline constexpr Scalar kMinNormalCosine = Scalar(0.97);  ///< of the largest angle between planes that are merged
inline constexpr Scalar kSamePlaneGate = Scalar(9);       ///< chi-square of a point of one plane against the other
inline constexpr Scalar kMergeGate = Scalar(16);  ///< chi-square of a point that moves to a plane merged with its own
inline constexpr int kPerOutlier = 10;  ///< points of a plane, of which one may be off another that it is merged with
}  // namespace plane_lifecycle

}  // namespace pf::tuning
