#pragma once

#include "base/scalar.h"

/// Tuned numbers of places, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// What a place is, and which of two is redundant.
namespace place {
inline constexpr int kMinPoints = 8;                   ///< as many as support a pose
inline constexpr Scalar kMaxDepthSigma = Scalar(0.3);  ///< relative sigma of the inverse depth of a point that is kept
inline constexpr Scalar kNear = Scalar(1);             ///< distance of views (place.h) that belong together
inline constexpr Scalar kApart = Scalar(0.25);         ///< the same, from which the filter makes another place
inline constexpr Scalar kGone = Scalar(2);             ///< the same, beyond which a place leaves the filter's state
inline constexpr int kMaxReturns = 6;                  ///< places that come back at once, where the map is found again
inline constexpr Scalar kFarShift = Scalar(0.5);       ///< [median depths] apart, where two views share about half
inline constexpr Scalar kFarTurn = Scalar(0.4);        ///< [rad] the same between directions of view
}  // namespace place

/// Which places an image may show.
namespace place_search {
inline constexpr int kMaxBits = 70;                   ///< that differ between two views of a point, nine times in ten
inline constexpr Scalar kMaxRatio = Scalar(0.85);     ///< of these to those of the second best corner
static constexpr int kCellCorners = 12;               ///< of each of the 48 parts of the image that are described
inline constexpr int kThreshold = 10;                 ///< [grey levels] of a corner
inline constexpr Scalar kSameCorner = Scalar(8);      ///< [px] between corners that show the same
inline constexpr int kMinMatches = 6;                 ///< of a place that is tried
inline constexpr int kSeed = 1;                       ///< of the generator that draws triples
inline constexpr int kTrials = 200;                   ///< triples, at most
inline constexpr Scalar kBoundWidth = Scalar(0.006);  ///< of an inlier, in image widths: corners lie within 2 px
inline constexpr Scalar kSigmaWidth = Scalar(0.002);  ///< standard deviation of such a corner, in image widths
inline constexpr Scalar kHuber = Scalar(2);           ///< residuals beyond count linearly [standard deviations]
inline constexpr int kRounds = 6;                     ///< of the refinement
inline constexpr Scalar kInflation = Scalar(4);       ///< of the covariance of such a pose, for what the map shares
}  // namespace place_search

/// A map that is recognised in an earlier one.
namespace map_join {
inline constexpr Scalar kOneScale = Scalar(1.12);  ///< ratio of the scales that two points have in common
inline constexpr int kMinRatios = 4;               ///< points that have the same scale
inline constexpr int kMinSame = 2;                 ///< one in so many points has the scale of most
inline constexpr int kRival = 2;                   ///< matches of the place that is recognised, for each of another one
}  // namespace map_join

}  // namespace pf::tuning
