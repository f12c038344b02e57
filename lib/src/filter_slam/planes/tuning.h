#pragma once

#include "base/scalar.h"

/// Tuned numbers of planes of the filter back end, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// Planes that somebody says are vertical.
namespace plane_vertical {
inline constexpr Scalar kVerticalGate = Scalar(15.1);  ///< chi-square of one degree of freedom, 0.9999
}  // namespace plane_vertical

namespace own_places {
inline constexpr Scalar kMaxMove = Scalar(0.25);  ///< along the ray, of the distance of the camera that saw it
inline constexpr Scalar kTold = Scalar(1000);     ///< N range^2: a hundredth of the distance is a third of a pixel
inline constexpr Scalar kElsewhere = Scalar(10);  ///< [px] of a match from there, where that says nothing any more
}  // namespace own_places

/// Features that began on a plane.
namespace plane_trials {
inline constexpr Scalar kPixel = 1;          ///< [px] of a match, with what it has in common with other frames'
inline constexpr Scalar kDoubt = Scalar(1);  ///< log-odds against it from which on it goes, since it bends the plane
inline constexpr Scalar kMinSlant = Scalar(0.05);  ///< sine of ray and plane; with less a depth constrains nothing
}  // namespace plane_trials

/// Planes that the map had when it began again.
namespace plane_resumption {
inline constexpr int kKnownShare = 2;  ///< one in so many of its points is known again, where the search for it decides
}  // namespace plane_resumption

namespace plane_places {
inline constexpr Scalar kPixel = 1;              ///< [px] of a match, before the points have said what it is
inline constexpr Scalar kMaxSigma = Scalar(30);  ///< of a height at one pixel that is looked at, in plane.max_distance
inline constexpr Scalar kMinSlant = Scalar(0.02);  ///< sine between plane and ray of a point that leaves it
inline constexpr Scalar kTwoSigma2 = Scalar(4);    ///< of the majority's plane: its variances count as so many
}  // namespace plane_places

}  // namespace pf::tuning
