#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "map/map.h"

/// Walls of the plan that no feature has been compared with yet: a known first pose saw none of them, and the map is one of points until a
/// wall comes into view (lib/docs/theory/walls.md).

namespace pf {

/// Whether the plan has a wall where this body's camera looks.
bool sees_walls(const Filter& filter, const Map& map, const Body& body);

/// Sets the walls of the plan apart: until one of them is seen, no measurement uses them.
void set_walls_apart(PlaneTable* planes);

/// Factor on the map's scale, about c0_W, with which most points that this frame saw before walls set apart lie on them. Zero where no
/// factor has a clear majority. c0_W: position of the first pose, which is known.
Scalar find_scale_by_walls(const Filter& filter, const Map& map, std::int64_t t_ns, const Vec3& c0_W);

/// Scales what the map keeps of lengths and places beside the filter, about a pivot in W.
void scale_tables(Scalar scale, const Vec3& pivot_W, Map* map);

}  // namespace pf
