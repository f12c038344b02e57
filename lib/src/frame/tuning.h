#pragma once

#include "base/scalar.h"

/// Tuned numbers of the back end, with units. tools/sweep-tuning halves and doubles them; what no sweep has measured has no figure here.

namespace pf::tuning {

/// What chance finds in wrong places of real images, measured in 48,000 searches (lib/docs/states.md).
namespace chance {
inline constexpr Scalar kMaxFindShare = Scalar(0.25);  ///< of searches that find something; found: 0.04 .. 0.24
inline constexpr Scalar kMinArea = Scalar(250);        ///< [px^2] per find in small ellipses, times kMaxFindShare
inline constexpr Scalar kMinShare = Scalar(1e-6);      ///< of a search that chance lets agree, at least
inline constexpr Scalar kMaxShare = Scalar(0.99);      ///< likewise, at most
inline constexpr int kLevels = 4;  ///< areas in which matches may agree: the gate's, 1/2, 1/4, 1/8 of it
inline constexpr Scalar kGateOfThree = Scalar(22.5);  ///< chi-square of six degrees of freedom, 0.999
}  // namespace chance

/// A frame while tracking.
namespace tracking {
inline constexpr int kMinInliers = 8;       ///< of a tracked frame, or half of map.features_in_view if that is less
inline constexpr int kMinInliersOfFew = 5;  ///< and never fewer than that
inline constexpr Scalar kMaxLogFalse = Scalar(-6.9);  ///< ln 0.001 consensuses as good that chance gives per frame
inline constexpr int kTriples = 8;                    ///< of inliers, with which that number is computed
inline constexpr Scalar kMaxYoungGap = Scalar(0.2);   ///< [s] untracked, after which a young map is no longer followed
inline constexpr Scalar kMaxLensDeviation = Scalar(3);  ///< prior sigmas of an estimated lens without a warning
}  // namespace tracking

/// Whether a pose can be used.
namespace usable_pose {
inline constexpr Scalar kMaxRotationSigma = Scalar(0.349);  ///< [rad] 20 degrees
inline constexpr Scalar kMaxPositionSigma = Scalar(0.5);    ///< in median depths
}  // namespace usable_pose

/// Finding the map again.
namespace relocaliser {
inline constexpr Scalar kMaxLogFalse = Scalar(-13.8);  ///< ln 1e-6 consensuses as good that chance gives per frame
inline constexpr int kTriples = 40;                    ///< of inliers, with which that number is computed
inline constexpr int kFramesNearby = 2;    ///< in a row with a consensus about the prediction, after a short gap
inline constexpr int kFramesAnywhere = 3;  ///< in a row that agree; in random order one in 20 shows a neighbour
inline constexpr Scalar kNearbySigma = Scalar(0.1);  ///< [rad] rotation sigma of a prediction that is searched linearly
inline constexpr Scalar kMaxDepthSigma = Scalar(0.3);  ///< relative sigma of an inverse depth that may place the camera
inline constexpr Scalar kProposalPixels = Scalar(0.004);  ///< sigma of a match against the map, in image widths
inline constexpr float kMinRecognition = 0.5f;            ///< correlation of a kept view that is searched about
inline constexpr Scalar kAboutView = Scalar(0.1);         ///< sigma of the pose about a kept view [rad], and in depths
inline constexpr Scalar kAboutProposal = Scalar(0.03);    ///< likewise about the last frame's proposal
inline constexpr Scalar kMapSigma = Scalar(2);            ///< [px] of a point of the map in a search about such a pose
inline constexpr int kColumns = 4;                        ///< cells of the image
inline constexpr int kRows = 3;                           ///< cells of the image
inline constexpr int kMinCells = 4;                       ///< that hold inliers
inline constexpr Scalar kProposalRotation = Scalar(0.035);  ///< [rad] of proposals apart, on top of the motion
inline constexpr Scalar kProposalShift = Scalar(0.05);      ///< likewise, in depths
inline constexpr Scalar kMotionGate = Scalar(3);            ///< sigmas of the velocities
inline constexpr Scalar kMaxRateSigma = Scalar(1);          ///< [rad/s] of a hand
inline constexpr Scalar kMaxSpeedSigma = Scalar(0.5);       ///< [depths/s] of a hand
}  // namespace relocaliser

/// How far a body that nothing measures may be predicted.
namespace body_motion {
inline constexpr Scalar kSpeedDecay = Scalar(0.25);       ///< [s] time constant of a speed that is not measured
inline constexpr Scalar kMaxRotationSigma = Scalar(0.5);  ///< [rad] of an axis; beyond, angular noise is left out
inline constexpr Scalar kMaxSpeedSigma = Scalar(1);       ///< [m/s] of an axis; beyond, linear noise is left out
inline constexpr Scalar kAnyRotation = Scalar(1.8);       ///< [rad] uniform over a full rotation: the most that grows
inline constexpr Scalar kAnyPosition = Scalar(100);       ///< [m] likewise
inline constexpr Scalar kLeastSpeedSigma = Scalar(1e-3);  ///< [m/s, rad/s] of an axis whose speed has decayed
}  // namespace body_motion

/// An inertial unit before anything is known of it.
namespace inertial {
inline constexpr Scalar kGyroBias = Scalar(0.1);   ///< [rad/s] sigma of each axis
inline constexpr Scalar kAccelBias = Scalar(0.2);  ///< [m/s^2] sigma of each axis
inline constexpr Scalar kGravity = Scalar(1);      ///< [rad] sigma of its direction: nothing is known
inline constexpr Scalar kYoungMap = Scalar(15);    ///< [s] age of a map of unknown scale that gives way to a metric one
}  // namespace inertial

/// Whether samples and pictures agree. Slack and bound are from six healthy runs of 60 s (largest sum 38) and wrong units (pf-sim --fault).
namespace unit_watch {
inline constexpr Scalar kSlack = Scalar(9);              ///< that a frame may add to the sum, of a chi-square of six
inline constexpr Scalar kBound = Scalar(100);            ///< of the sum, above which the unit is doubted
inline constexpr Scalar kBoundOnProbation = Scalar(30);  ///< in the first kTrial of its use after a doubt
inline constexpr Scalar kMaxOfFrame = Scalar(50);        ///< no single frame is enough
inline constexpr Scalar kMaxPoseNis = Scalar(38.3);      ///< chi-square of six, 1 - 1e-6: samples are not used for it
inline constexpr Scalar kSilence = Scalar(0.1);          ///< [s] without a sample, after which none is waited for
inline constexpr Scalar kRate = Scalar(1);               ///< [rad/s] sigma of the rate where samples were wrong
inline constexpr Scalar kSpeed = Scalar(1);              ///< [m/s] sigma of the velocity likewise, or in units of W
inline constexpr Scalar kTime = Scalar(0.2);             ///< [s] for which the pose may have followed wrong samples
inline constexpr Scalar kTrial = Scalar(5);              ///< [s] in metres, before which a map hangs on the unit alone
inline constexpr Scalar kWindow = Scalar(3);  ///< [s] for which a doubted gyro must agree; doubles with each doubt
inline constexpr int kMaxDoublings = 8;       ///< of that
inline constexpr Scalar kMaxScatter = Scalar(1.5);  ///< of gyro less rate, in variances
inline constexpr Scalar kMaxShare = Scalar(0.1);    ///< of the rate's own scatter that gyro less rate may have
inline constexpr Scalar kMinPower = Scalar(100);    ///< of the rate over its variance, summed: rest proves nothing
inline constexpr int kMinFrames = 30;               ///< that such a test wants
}  // namespace unit_watch

/// Standing still.
namespace rest {
inline constexpr Scalar kTime = Scalar(1);                ///< [s] at rest before it counts
inline constexpr int kMinSamples = 20;                    ///< in that time
inline constexpr Scalar kMaxScatter = Scalar(2);          ///< standard deviations that the densities allow
inline constexpr Scalar kMaxGyroBias = Scalar(0.3);       ///< [rad/s] that a gyro at rest may show
inline constexpr Scalar kMaxGravityError = Scalar(1);     ///< [m/s^2] of the mean specific force
inline constexpr Scalar kMaxMotionPx = Scalar(1);         ///< [px] of the picture as a whole, root mean square
inline constexpr int kMinPixels = 8;                      ///< features by which that is judged
inline constexpr Scalar kMaxApartPx = Scalar(3);          ///< [px] of these from their median displacement
inline constexpr Scalar kMinMotionPx = Scalar(0.2);       ///< [px] least motion that the picture can tell from none
inline constexpr Scalar kMinMeanMotionPx = Scalar(0.05);  ///< [px] likewise of its mean over kMeanGain's frames
inline constexpr Scalar kMaxMeanMotionPx = Scalar(0.3);   ///< [px] of that since the rest began
inline constexpr Scalar kMeanGain = Scalar(0.1);          ///< of that running mean, per frame
inline constexpr Scalar kMaxNis = Scalar(38.3);  ///< chi-square of six, 1 - 1e-6: beyond it samples say it moves
inline constexpr Scalar kAnyNis = Scalar(1e9);   ///< the same, once the frame has shown no motion
inline constexpr Scalar kHidden = Scalar(2);     ///< sigmas of a frame's mean acceleration that pass for none
}  // namespace rest

/// Features that fail, and the depth of new ones.
namespace feature_keeper {
inline constexpr int kMinAttempts = 10;         ///< before a feature is judged
inline constexpr int kMaxFailures = 12;         ///< in a row, of a feature that was measured often
inline constexpr int kMaxEarlyFailures = 4;     ///< in a row, of a feature with fewer than kMinAttempts measurements
inline constexpr int kMinDepths = 8;            ///< for a median
inline constexpr Scalar kBehindTarget = 2;      ///< assumed depth of the scene, in depths of the target
inline constexpr Scalar kSureSign = Scalar(9);  ///< chi-square of an inverse depth, above which its sign is certain
}  // namespace feature_keeper

/// What a start assumes.
namespace filter_start {
inline constexpr Scalar kStartSpeed = Scalar(0.5);     ///< [m/s] sigma, or in start depths where these are the unit
inline constexpr Scalar kStartRate = Scalar(0.5);      ///< [rad/s] sigma
inline constexpr Scalar kKnownSpeed = Scalar(2);       ///< sigmas of a given speed above which it tells the scale
inline constexpr Scalar kDefinedSigma = Scalar(1e-5);  ///< [rad, m] of a pose that defines the world
inline constexpr Scalar kWideDepth = Scalar(0.5);      ///< relative sigma of the depths with which the filter restarts
inline constexpr int kProven = 4;                      ///< frames that found a feature: in none of them by chance
inline constexpr Scalar kSameDepth = Scalar(1.25);     ///< ratio of two; right: 0.91 .. 1.06, wrong: 0.3 .. 0.4
}  // namespace filter_start

/// New features.
namespace image_corners {
inline constexpr int kCornerThreshold = 8;       ///< [grey levels] of the segment test
inline constexpr float kMinCornerScore = 12.0f;  ///< smaller eigenvalue of the gradients [grey levels^2/px^2]
inline constexpr int kFaintThreshold = 3;        ///< [grey levels] likewise, where such corners leave too few in view
inline constexpr float kFaintScore = 1.5f;       ///< likewise
inline constexpr int kFaintBelow = 2;            ///< tracked frames' least inliers in view, below which it is that
inline constexpr int kMinNewFeatures = 4;        ///< in one frame; new features share an anchor
inline constexpr int kMaxInCell = 3;             ///< features in a cell of the image; one more where it shows a plane
inline constexpr int kPlaneAhead = 2;            ///< features that do not count there when cells take turns
}  // namespace image_corners

/// The order in which features are searched.
namespace image_front_end {
inline constexpr float kIncomparable = 1000;  ///< taken off the rate of what cannot be compared: more than any rate
inline constexpr int kScouts = 12;            ///< candidates that are measured first when the pose is uncertain
inline constexpr Scalar kWideEllipse = Scalar(6);  ///< [px] largest semi-axis above which scouts are measured first
inline constexpr int kMinConsensus = 5;            ///< inliers that a consensus needs during a start
inline constexpr Scalar kFewFound = Scalar(0.75);  ///< share below which searches of a start follow the picture
inline constexpr int kSettled = 5;  ///< measurements of a feature whose residuals are those of its matches
}  // namespace image_front_end

/// Where the picture as a whole has gone.
namespace followed_view {
inline constexpr Scalar kSigma = Scalar(0.3);   ///< [px of a thumbnail] of a pixel, for a shift is taken as a turn
inline constexpr Scalar kWideArea = Scalar(4);  ///< least area of a wide ellipse in those about followed pixels
}  // namespace followed_view

/// Matches that enter the update.
namespace pixel_update {
inline constexpr Scalar kOthersGate = Scalar(1.5);  ///< gates, of one match against all others: (1/100)^1.5 is 1/1000
}  // namespace pixel_update

/// Groups of young features against the older ones.
namespace leave_one_out {
inline constexpr Scalar kGroupDeviations = Scalar(4);  ///< standard deviations of a normal variable: 1 in 30,000
inline constexpr int kYoung = 20;  ///< [frames] that a feature of such a group was measured in, fewer
}  // namespace leave_one_out

/// A camera at rest.
namespace same_view {
inline constexpr Scalar kMaxMotionPx = Scalar(2);   ///< [px] of points near the median depth; errors come again
inline constexpr Scalar kDepthRatio = Scalar(1.5);  ///< how near: the median depth divided by it, and times it
inline constexpr Scalar kCorner = Scalar(0.4);      ///< tangent of the angles at which such points are looked at
}  // namespace same_view

/// The noise of matches in images (lib/docs/noise.md).
namespace noise {
inline constexpr Scalar kReferenceSigma = Scalar(0.25);  ///< [px] of the first view, which later ones are compared with
inline constexpr Scalar kSearchSigma = Scalar(0.6);      ///< [px] of a match before the image says how good it is
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
inline constexpr int kConverged = 10;                ///< observations before a point may be folded
inline constexpr int kDiscoverEvery = 5;             ///< frames
inline constexpr int kMaxRejections = 4;             ///< in a row, before a folded point is unfolded
inline constexpr int kTrialMatches = 10;             ///< of a feature that began on a plane, before it is believed
inline constexpr int kTrialRejections = 2;           ///< in a row, before it is dropped
inline constexpr Scalar kTrialDepth = Scalar(0.05);  ///< of its depth, which must show before it is believed
inline constexpr Scalar kTrialPixels = Scalar(1.8);  ///< [px] that show: three sigma of a match
inline constexpr int kMinFixed = 4;                  ///< points that a point group needs
inline constexpr Scalar kReach = Scalar(0.5);        ///< beyond the outline of a plane, in square roots of its area
inline constexpr Scalar kUnfoldSigma = Scalar(10);   ///< of an unfolded point along the normal, in plane.max_distance
}  // namespace plane_keeper

/// Planes known beforehand.
namespace plane_walls {
inline constexpr int kMaxOthers = 64;                 ///< walls: the largest capacity.max_planes
inline constexpr Scalar kKnownScale = Scalar(0.05);   ///< sigma of the log scale, below which any wall may take points
inline constexpr Scalar kOffWall = Scalar(0.5);       ///< sigma of a new point relative to the depth of its wall
inline constexpr int kTrials = 60;                    ///< triples of points
inline constexpr Scalar kTripleGate = Scalar(11.34);  ///< chi-square of three degrees of freedom, 0.99
}  // namespace plane_walls

/// Walls that are doubted.
namespace plane_doubt {
inline constexpr Scalar kRefusedGate = Scalar(16);  ///< chi-square of a point that does not lie on a wall
inline constexpr int kMinRefused = 8;               ///< points, before a wall is doubted or believed again
inline constexpr Scalar kDoubtedPrior = 100;        ///< times its covariance that a doubted wall's prior gets
inline constexpr int kRefusedShare = 4;             ///< refused points for each on the wall, above which it is doubted
inline constexpr int kCells = 5;                    ///< along each side of the image
}  // namespace plane_doubt

/// Planes that somebody says are vertical.
namespace plane_vertical {
inline constexpr Scalar kVerticalGate = Scalar(15.1);  ///< chi-square of one degree of freedom, 0.9999
}  // namespace plane_vertical

/// Patches on walls: finding them again.
namespace patch_keeper {
inline constexpr Scalar kMinCosine = Scalar(0.407);    ///< of the slant at which a patch is looked for: 66 degrees
inline constexpr Scalar kCornersGate = Scalar(26.12);  ///< chi-square of eight degrees of freedom, 0.999
inline constexpr Scalar kCornerSigma = Scalar(0.05);   ///< [px] of a corner, beside the noise: warp and interpolation
inline constexpr float kWarpSlack = 0.1f;              ///< [px] of pixels, as far as it excuses residuals
inline constexpr int kSettledFrames = 5;               ///< of a patch, before its residuals say what the noise is
inline constexpr Scalar kAlignerReach = Scalar(12);    ///< [px] of the gate, beyond which a patch is searched for first
inline constexpr Scalar kLinearReach = Scalar(4);      ///< [px] of an innovation that is taken in as it is
inline constexpr Scalar kPoseSigma = Scalar(1);        ///< [px] of what is not the pose, where the pose is sought
inline constexpr int kPoseSteps = 6;                   ///< of that search
inline constexpr int kMaxFailures = 30;                ///< in a row, before a patch is dropped
inline constexpr int kMaxEarlyFailures = 3;            ///< likewise of one that waits for its plane
inline constexpr int kMaxRejections = 4;               ///< in a row
inline constexpr int kUpheldFrames = 30;               ///< that a patch was measured, for its wall to be upheld by it
}  // namespace patch_keeper

/// Patches on walls: new ones.
namespace patch_selection {
inline constexpr Scalar kMinBirthCosine = Scalar(0.616);  ///< of the slant at birth: 52 degrees
inline constexpr Scalar kLastingCosine = Scalar(0.515);   ///< of the slant of a patch that will last: 59 degrees
inline constexpr Scalar kMargin = Scalar(0.1);  ///< around a patch that must be on the wall too, of half its side
inline constexpr Scalar kApart = Scalar(0.6);   ///< of the middles of two patches, in sides
inline constexpr int kOnWall = 3;               ///< patches of a wall in view
inline constexpr int kBetween = 15;             ///< frames from one that begins on a wall to the next
inline constexpr int kRetryFrames = 5;          ///< likewise where the wall has none in view, or had no place
inline constexpr int kSizes = 4;                ///< parts of the side: a patch has all, or
inline constexpr int kSmallest = 1;             ///< fewer, but more than this
inline constexpr int kMinSide = 32;             ///< [px]
inline constexpr Scalar kObstacleGate = Scalar(6.63);  ///< chi-square, 0.99: above it a point is not on the wall
inline constexpr int kCoarseSide = 52;                 ///< [px] from which texture is judged on level 2
}  // namespace patch_selection

/// Whole planes.
namespace plane_lifecycle {
inline constexpr int kMinPoints = 4;               ///< of a plane that once had more than plane.min_points
inline constexpr int kMaxWeakFrames = 60;          ///< in a row, before a plane without enough points is dissolved
inline constexpr Scalar kMaxSlant = Scalar(0.05);  ///< of a plane against its frame, above which it gets another frame
inline constexpr Scalar kMinNormalCosine = Scalar(0.97);  ///< of the largest angle between planes that are merged
inline constexpr Scalar kSamePlaneGate = Scalar(9);       ///< chi-square of a point of one plane against the other
inline constexpr Scalar kMergeGate = Scalar(16);  ///< chi-square of a point that moves to a plane merged with its own
}  // namespace plane_lifecycle

/// Poses from triples of matches.
namespace pose_proposal {
inline constexpr int kTrials = 120;                   ///< triples
inline constexpr int kSteps = 6;                      ///< of Gauss-Newton
inline constexpr int kRefits = 3;                     ///< to all inliers
inline constexpr Scalar kMaxStep2 = Scalar(10);       ///< [rad^2] squared rotation of a step; a larger one has diverged
inline constexpr Scalar kSmallStep2 = Scalar(1e-10);  ///< [rad^2, m^2] squared step that ends the fit
}  // namespace pose_proposal

/// Starting at known points.
namespace start_at_target {
inline constexpr Scalar kCornerSigma = Scalar(0.25);  ///< [px] of a corner: the intersection of two lines
inline constexpr Scalar kMaxRmsPx = Scalar(2);        ///< [px] of the reprojection errors of known points
inline constexpr Scalar kMinReach = Scalar(6);        ///< [px] search radius of a known point, at least
inline constexpr Scalar kMaxReach = Scalar(60);       ///< [px] likewise, at most
inline constexpr Scalar kFlatness = Scalar(0.01);  ///< of points on a plane: their spread across it over their largest
}  // namespace start_at_target

}  // namespace pf::tuning
