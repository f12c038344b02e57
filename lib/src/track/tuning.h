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

}  // namespace pf::tuning
