#pragma once

#include "base/scalar.h"

/// Tuned numbers of tracking, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// Search and alignment of a feature.
namespace match {
inline constexpr Scalar kSearchRadius = Scalar(9);  ///< [px of the level]; a larger ellipse is searched one level up
inline constexpr float kMinSearchScore = 0.6f;      ///< normalised correlation of the peak
inline constexpr float kMinScore = 0.8f;            ///< normalised correlation of the aligned window
inline constexpr float kMinPeakLead = 0.04f;        ///< of the first peak over the second; less means repeated texture
inline constexpr Scalar kMinScale = Scalar(0.25);   ///< source pixels per current pixel of views that compare, from
inline constexpr Scalar kMaxScale = Scalar(3.2);    ///< to
inline constexpr Scalar kMinSharpness = Scalar(0.6);  ///< source pixels per pixel of the level that is searched
inline constexpr Scalar kSearchFloor = Scalar(0.1);   ///< [px^2 of the level] added to the ellipse that is searched
}  // namespace match

/// Images made small.
namespace thumbnail {
inline constexpr int kMinVariance = 1;  ///< [grey levels^2] of a thumbnail that can be recognised
}  // namespace thumbnail

/// Thumbnails of tracked frames.
namespace view_memory {
inline constexpr int kMaxShift = 8;        ///< [px of the thumbnail] to each side, within which views are compared
inline constexpr float kKnownView = 0.8f;  ///< correlation above which a view is kept already
}  // namespace view_memory

/// The rotation between two thumbnails.
namespace image_rotation {
inline constexpr int kReach = 12;                   ///< [px of the thumbnail] to each side that are searched first
inline constexpr float kMinShiftScore = 0.5f;       ///< correlation at the best shift
inline constexpr float kMinOverlapScore = 0.7f;     ///< correlation at the end, over what both show
inline constexpr int kMinOverlap = 300;             ///< [px of the thumbnail] that both show: a quarter
inline constexpr int kMaxRounds = 10;               ///< of Gauss-Newton
inline constexpr Scalar kMaxTurn = Scalar(0.2);     ///< [rad] of one round
inline constexpr Scalar kSmallTurn = Scalar(1e-3);  ///< [rad] of the last one: a thirtieth of a pixel
}  // namespace image_rotation

/// Sub-pixel sides of a quadrilateral.
namespace quad_refine {
static constexpr Scalar kReach = 5;                    ///< across a side, each way [px]
static constexpr Scalar kStep = Scalar(0.5);           ///< between samples [px]
inline constexpr Scalar kRobust = Scalar(0.4);         ///< residual that counts half [px]
inline constexpr Scalar kMaxRms = Scalar(1.0);         ///< of a side [px]
inline constexpr Scalar kMaxMove = 4;                  ///< of a corner [px]
inline constexpr Scalar kMinFrontal = Scalar(0.34);    ///< cosine between the view and the normal: 70 degrees
inline constexpr Scalar kMinSlope = Scalar(0.08);      ///< of the steepest; the rise ends below
inline constexpr Scalar kCornerMargin = Scalar(3.5);   ///< left out at the ends of a side [px]
inline constexpr Scalar kMinMargin = Scalar(0.08);     ///< the same at least, in parts of its length
inline constexpr Scalar kMaxMargin = Scalar(0.4);      ///< the same at most: a shorter side is not refined
inline constexpr Scalar kAhead = Scalar(0.02);         ///< in parts of a side, for its direction there
inline constexpr Scalar kMinMeeting = Scalar(0.05);    ///< sine between two sides
inline constexpr Scalar kMisfitSigmas = Scalar(1.5);   ///< of a rectangle's corners, in their sigma
inline constexpr Scalar kMisfitShare = Scalar(0.003);  ///< the same in addition, in its diagonals
inline constexpr int kMinRises = 2;                    ///< one in so many places of a side has a rise
inline constexpr int kMinClear = 2;                    ///< one in so many places of a side lies on no masked cell
}  // namespace quad_refine

/// Search for a patch on a plane that is far from where it is expected.
namespace patch_search {
inline constexpr float kMinContrast = 4.0f;  ///< standard deviation of its coarse pixels [grey levels]
inline constexpr float kMinScore = 0.5f;     ///< normalised correlation of the peak
inline constexpr float kMinLead = 0.05f;     ///< of the first peak over the second; less means repeated texture
inline constexpr int kPeakWidth = 3;         ///< [px of the level] from a peak, beyond which another one begins
inline constexpr int kMaxFineReach = 24;     ///< [px of level 2] of an ellipse; a larger one is searched one level up
inline constexpr int kMaxReach = 8192;       ///< [px of the level] of a place that is no overflow
}  // namespace patch_search

/// Alignment of patches on planes.
namespace align_plane {
inline constexpr int kMaxCoarseSamples = 1200;  ///< of a coarse level; above, every other pixel
inline constexpr int kCoarseIterations = 3;     ///< on each level but the finest
inline constexpr int kShiftIterations = 2;      ///< before them
inline constexpr float kCutOff = 4.685f;        ///< of the weights [standard deviations]; 95 % as good as least squares
inline constexpr float kMinSigma = 0.5f;        ///< of residuals [grey levels]
inline constexpr float kNominalNoise = 2.0f;    ///< of a pixel, against which slack is weighed [grey levels]
inline constexpr float kSmallStep = 0.03f;      ///< of a corner on the finest level [px]
inline constexpr float kLastStep = 0.15f;       ///< the same of the last iteration that there may be
inline constexpr float kCoarseStep = 0.15f;     ///< the same on the other levels [px of the level]
inline constexpr float kMaxStep = 0.5f;         ///< of a corner in one iteration [sides of the patch]
inline constexpr float kNoWay = 1e6f;           ///< of a corner, where it is no number [half sides]
inline constexpr float kMinGain = 0.05f;        ///< of the image against the patch
inline constexpr float kMaxGradientNoise = 0.75f;  ///< share of the gradients' squares that is taken as noise
inline constexpr float kMinCorrelation = 0.85f;    ///< of what has weight
inline constexpr float kMinWeight = 0.33f;         ///< of the samples, those that have weight
inline constexpr float kMinAspect = 0.4f;          ///< smaller to larger stretch of the patch: a slant of 66 degrees
inline constexpr float kMinStretch = 0.3f;         ///< larger stretch of the patch, image against reference
inline constexpr float kMaxStretch = 3.0f;         ///< the same
}  // namespace align_plane

/// Slopes of a template's surface.
namespace template_normal {
inline constexpr Scalar kMinLeverage = Scalar(0.8);  ///< [px] at the rim by a unit of slope, at least, to be measured
inline constexpr Scalar kWarpError = Scalar(0.1);    ///< [px] at the rim that comes from elsewhere
inline constexpr Scalar kMaxSigma = Scalar(0.7);     ///< of a measured slope
inline constexpr Scalar kMaxStep = 1;                ///< of a slope in one frame
inline constexpr Scalar kWalk = Scalar(0.01);        ///< of a slope from frame to frame
inline constexpr Scalar kCorrelation = 4;            ///< frames that have the same error
}  // namespace template_normal

/// Templates with a mask.
namespace template_match {
static constexpr int kReach = 4;                       ///< [px] to each side that are searched
inline constexpr Scalar kFloor = Scalar(0.1);          ///< [px^2] added to the ellipse that is searched
inline constexpr float kMinPeak = 0.5f;                ///< correlation by the mask's weights, of the peak
inline constexpr float kMinPeakLead = 0.04f;           ///< of the first peak over the second
inline constexpr float kApart = 2.5f;                  ///< [px] between peaks
inline constexpr float kRim = 0.5f;                    ///< [px] of a template's pixel beyond its centre
inline constexpr Scalar kMaxMove = 2;                  ///< [px] of the sub-pixel place from where the search ended
inline constexpr Scalar kMinScale = Scalar(0.6);       ///< source pixels per current pixel of views, from
inline constexpr Scalar kMaxScale = Scalar(1.6);       ///< to
inline constexpr float kFirstSlopeSigma = 0.7f;        ///< of a surface that is taken to face the camera
inline constexpr Scalar kMaxSlopeSigma = Scalar(0.3);  ///< of a slope, as far as it excuses residuals
inline constexpr float kWarpSlack = 0.1f;              ///< [px] of a warp, as far as it excuses residuals
inline constexpr float kSlackSigmas = 1.0f;            ///< of the warp, as far as they excuse residuals
inline constexpr float kDark = 1.0f;                   ///< [grey levels]; what is darker may be cut off
inline constexpr float kBright = 254.0f;               ///< [grey levels]; what is brighter may be cut off
inline constexpr float kMinKept = 0.5f;                ///< of a mask's area that one frame may leave
inline constexpr float kMaxLearntMisfit = 1.0f;        ///< of a match that a mask learns from [sigma_plane^2]
inline constexpr float kMinArea = 30.0f;               ///< [px] of a mask
}  // namespace template_match

/// Which plane a patch lies on.
namespace patch_wait {
inline constexpr int kPersist = 3;     ///< frames in a row with the same result for a plane, before it counts
inline constexpr int kMaxFrames = 30;  ///< before it joins without parallax; and without a plane, before one is founded
}  // namespace patch_wait

}  // namespace pf::tuning
