#pragma once

#include "base/eigen.h"
#include "vision/contour.h"

namespace pf {

/// The four corners of an outline that is a convex quadrilateral with nearly straight sides, clockwise as seen, in
/// pixel coordinates. False for any other outline; corners are then undefined.
bool quad_corners(const Contour& contour, Vec2 corners[4]);

/// Rotates the order of four clockwise corners so that the first side points as nearly right as possible.
void order_upright(Vec2 corners[4]);

}  // namespace pf
