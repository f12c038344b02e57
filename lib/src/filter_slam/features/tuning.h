#pragma once

#include "base/scalar.h"

/// Tuned numbers of features of the filter back end, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// A camera at rest.
namespace same_view {
inline constexpr Scalar kMaxMotionPx = Scalar(2);   ///< [px] of points near the median depth; errors repeat below it
inline constexpr Scalar kDepthRatio = Scalar(1.5);  ///< depths from the median divided by it to the median times it
inline constexpr Scalar kCorner = Scalar(0.4);      ///< tangent of the angles at which such points are tested
}  // namespace same_view

/// Planes known beforehand.
namespace plane_walls {
inline constexpr Scalar kKnownScale = Scalar(0.05);  ///< sigma of the log scale, below which any wall may take points
}  // namespace plane_walls

}  // namespace pf::tuning
