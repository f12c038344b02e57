#pragma once

#include "base/scalar.h"

/// Tuned numbers of tracking: what each one means and its unit. tools/sweep-tuning halves and doubles them; what no
/// sweep has measured has no figure here.

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

/// Thumbnails of tracked frames.
namespace view_memory {
inline constexpr int kMaxShift = 8;        ///< [px of the thumbnail] to each side, within which views are compared
inline constexpr float kKnownView = 0.8f;  ///< correlation above which a view is kept already
inline constexpr int kMinVariance = 1;     ///< [grey levels^2] of a thumbnail that can be recognised
}  // namespace view_memory

/// Sub-pixel sides of a quadrilateral.
namespace quad_refine {
inline constexpr Scalar kReach = 5;                    ///< across a side, each way [px]
inline constexpr Scalar kStep = Scalar(0.5);           ///< between samples [px]
inline constexpr Scalar kRobust = Scalar(0.4);         ///< residual that counts half [px]
inline constexpr Scalar kMaxRms = Scalar(1.0);         ///< of a side [px]
inline constexpr Scalar kMaxMove = 4;                  ///< of a corner [px]
inline constexpr Scalar kMinFrontal = Scalar(0.34);    ///< cosine between the view and the normal: 70 degrees
inline constexpr Scalar kMinSlope = Scalar(0.08);      ///< of the steepest; the rise ends below
inline constexpr Scalar kCornerMargin = Scalar(3.5);   ///< left out at the ends of a side [px]
inline constexpr Scalar kMinMargin = Scalar(0.08);     ///< likewise at least, in parts of its length
inline constexpr Scalar kMaxMargin = Scalar(0.4);      ///< likewise at most: a shorter side is not refined
inline constexpr Scalar kAhead = Scalar(0.02);         ///< in parts of a side, for its direction there
inline constexpr Scalar kMinMeeting = Scalar(0.05);    ///< sine between two sides
inline constexpr Scalar kMisfitSigmas = Scalar(1.5);   ///< of a rectangle's corners, in their sigma
inline constexpr Scalar kMisfitShare = Scalar(0.003);  ///< likewise in addition, in its diagonals
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
inline constexpr float kSmallStep = 0.03f;      ///< of a corner on the finest level [px]
inline constexpr float kLastStep = 0.15f;       ///< likewise of the last iteration that there may be
inline constexpr float kCoarseStep = 0.15f;     ///< likewise on the other levels [px of the level]
inline constexpr float kMaxStep = 0.5f;         ///< of a corner in one iteration [sides of the patch]
inline constexpr float kNoWay = 1e6f;           ///< of a corner, where it is no number [half sides]
inline constexpr float kMinGain = 0.05f;        ///< of the image against the patch
inline constexpr float kMaxGradientNoise = 0.75f;  ///< share of the gradients' squares that is taken as noise
inline constexpr float kMinCorrelation = 0.85f;    ///< of what has weight
inline constexpr float kMinWeight = 0.33f;         ///< of the samples, those that have weight
inline constexpr float kMinAspect = 0.4f;          ///< smaller to larger stretch of the patch: a slant of 66 degrees
inline constexpr float kMinStretch = 0.3f;         ///< larger stretch of the patch, image against reference
inline constexpr float kMaxStretch = 3.0f;         ///< likewise
}  // namespace align_plane

}  // namespace pf::tuning
