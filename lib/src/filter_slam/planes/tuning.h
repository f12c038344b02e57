#pragma once

#include "base/scalar.h"

/// Tuned numbers of planes of the filter back end, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// Walls that are doubted.
namespace plane_doubt {
inline constexpr Scalar kRefusedGate = Scalar(16);  ///< chi-square of a point that does not lie on a wall
inline constexpr int kMinRefused = 8;               ///< points, before a wall is doubted or believed again
inline constexpr Scalar kDoubt = 1;  ///< log-odds against it from which on it goes, since it bends the plane
inline constexpr Scalar kMinSlant = Scalar(0.05);  ///< sine between plane and ray, below which a depth tells nothing
}  // namespace plane_doubt

namespace plane_places {
inline constexpr Scalar kPixel = 1;              ///< [px] of a match, before the points have said what it is
inline constexpr Scalar kMaxSigma = Scalar(30);  ///< of a height at one pixel that is looked at, in plane.max_distance
inline constexpr Scalar kMinSlant = Scalar(0.02);  ///< sine between plane and ray of a point that leaves it
inline constexpr Scalar kTwoSigma2 = Scalar(4);    ///< of the majority's plane: its variances count as so many
}  // namespace plane_places

}  // namespace pf::tuning
