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

/// Extends the outline until it contains the points. Beyond kMaxOutline vertices, removes the one that costs the least area, so that
/// the outline never leaves the convex hull. Points in any order and number; those that are not finite are ignored.
void extend_outline(PlaneOutline* outline, const Vec2* uv, int count);

inline constexpr int kOutlineBatch = 96;  ///< points that reject_isolated compares

/// Moves isolated points out of the list, keeping the order of the others; returns how many remain. A point is isolated if its second
/// nearest neighbour is more than five times as far as the median of that distance. Of fewer than six points, none is.
/// count <= kOutlineBatch
int reject_isolated(Vec2* uv, int count);

/// Twice the signed area of a triangle: positive if a, b, c are counter-clockwise.
Scalar twice_area(const Vec2& a, const Vec2& b, const Vec2& c);

/// [m²]
Scalar outline_area(const PlaneOutline& outline);

/// Inside or on the edge. margin [m] widens each edge outwards, and is positive for the nearly inside.
bool outline_contains(const PlaneOutline& outline, const Vec2& uv, Scalar margin = 0);

}  // namespace pf
