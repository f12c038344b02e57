#pragma once

#include "base/eigen.h"

namespace pf {

inline constexpr int kMaxOutline = 24;  ///< PF_OUTLINE_MAX

/// The part of a plane that is known: a convex polygon in the plane's coordinates [m], counter-clockwise, seen against
/// the normal. Fewer than three vertices: nothing but points or a line is known, and the area is zero.
struct PlaneOutline {
  int count = 0;
  Vec2 uv[kMaxOutline];
};

/// The outline grows until it holds the points. Beyond kMaxOutline vertices, the one whose loss costs least area goes, so
/// that it never oversteps the convex hull. Any order, any number of points; those that are not finite are left out.
void extend_outline(PlaneOutline* outline, const Vec2* uv, int count);

inline constexpr int kOutlineBatch = 96;  ///< points that are held against one another

/// Those of the points that have company come first, in their order; returns how many. A point is alone when the second nearest
/// of the others is more than five times as far as it commonly is (the median). Of fewer than six, none is.
/// count <= kOutlineBatch
int reject_isolated(Vec2* uv, int count);

/// Twice the signed area of a triangle: positive when a, b, c turn left.
Scalar twice_area(const Vec2& a, const Vec2& b, const Vec2& c);

/// [m²]
Scalar outline_area(const PlaneOutline& outline);

/// Inside or on the edge. margin [m] widens each edge outwards, and is positive for the nearly inside.
bool outline_contains(const PlaneOutline& outline, const Vec2& uv, Scalar margin = 0);

}  // namespace pf
