#pragma once

#include "filter/filter.h"
#include "map/map.h"

/// Where rays meet the walls of a plan: planes of the map that were known beforehand.

namespace pf {

/// Whether a ray from origin_W meets this plane of the table inside its outline, on a side that can be seen. *range is from the origin,
/// in lengths of the direction.
bool meets_wall(const Filter& filter, const Map& map, int plane_entry, const Vec3& origin_W, const Vec3& direction_W,
                Scalar* range);

/// The first wall that a ray meets, not counting doubted ones; -1: none. *range as above; untouched where there is none.
int first_wall(const Filter& filter, const Map& map, const Vec3& origin_W, const Vec3& direction_W, Scalar* range);

/// How far along a ray the plan has a wall, in lengths of direction_W; zero where it has none there. The filter may have moved a wall to
/// where its depths are, or doubt it; here it is where it was when it came.
Scalar range_in_plan(const Filter& filter, const Map& map, const Vec3& origin_W, const Vec3& direction_W);

}  // namespace pf
