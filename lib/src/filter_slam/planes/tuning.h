#pragma once

#include "base/scalar.h"

/// Tuned numbers about what pixels of folded points tell of where these are (lib/docs/planes.md).

namespace pf::tuning {

namespace own_places {
inline constexpr Scalar kMaxMove = Scalar(0.25);  ///< along the ray, of the distance of the camera that saw it
inline constexpr Scalar kTold = Scalar(1000);     ///< N range^2: a hundredth of the distance is a third of a pixel
inline constexpr Scalar kElsewhere = Scalar(10);  ///< [px] of a match from there, where that says nothing any more
}  // namespace own_places
namespace plane_places {
inline constexpr Scalar kPixel = 1;              ///< [px] of a match, before the points have said what it is
inline constexpr Scalar kMaxSigma = Scalar(30);  ///< of a height at one pixel that is looked at, in plane.max_distance
inline constexpr Scalar kMinSlant = Scalar(0.02);  ///< sine between plane and ray of a point that leaves it
inline constexpr Scalar kTwoSigma2 = Scalar(4);    ///< of the majority's plane: its variances count as so many
}  // namespace plane_places

}  // namespace pf::tuning
