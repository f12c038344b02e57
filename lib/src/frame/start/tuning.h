#pragma once

#include "base/scalar.h"

/// Tuned numbers of starts, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// What a start assumes.
namespace filter_start {
inline constexpr Scalar kStartSpeed = Scalar(0.5);     ///< [m/s] sigma, or in start depths where these are the unit
inline constexpr Scalar kStartRate = Scalar(0.5);      ///< [rad/s] sigma
inline constexpr Scalar kKnownSpeed = Scalar(2);       ///< sigmas of a given speed above which it fixes the scale
inline constexpr Scalar kDefinedSigma = Scalar(1e-5);  ///< [rad, m] of a pose that defines the world
inline constexpr Scalar kWideDepth = Scalar(0.5);      ///< relative sigma of the depths with which the filter restarts
inline constexpr int kProven = 4;                      ///< frames that found a feature: in none of them by chance
inline constexpr Scalar kSameDepth = Scalar(1.25);     ///< ratio of two; right: 0.91 .. 1.06, wrong: 0.3 .. 0.4
inline constexpr int kMinSame = 2;                     ///< one in so many depths agrees with those of the record
}  // namespace filter_start

/// Starting at known points.
namespace start_at_target {
inline constexpr Scalar kCornerSigma = Scalar(0.25);  ///< [px] of a corner: the intersection of two lines
inline constexpr Scalar kMaxRmsPx = Scalar(2);        ///< [px] of the reprojection errors of known points
inline constexpr Scalar kMinReach = Scalar(6);        ///< [px] search radius of a known point, at least
inline constexpr Scalar kMaxReach = Scalar(60);       ///< [px] the same, at most
inline constexpr Scalar kFlatness = Scalar(0.01);  ///< of points on a plane: their spread across it over their largest
}  // namespace start_at_target

}  // namespace pf::tuning
