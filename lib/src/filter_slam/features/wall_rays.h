#pragma once

#include "filter/filter.h"
#include "map/map.h"
#include "map/wall_rays.h"

/// Where rays meet the walls of a plan: planes of the map that were known beforehand.

namespace pf {

/// Where the filter has the planes of the table.
struct FilterPlanes {
  const Filter& filter;
  const Map& map;

  PlaneAt operator()(int plane_entry) const {
    const Block& block = filter.state().block[map.planes[plane_entry].slot];
    return {filter.state().frame_of(block), block.xyz()};
  }
};

/// Whether a ray from origin_W meets this plane of the table inside its outline, on a side that can be seen. *range is from the origin,
/// in lengths of the direction.
bool meets_wall(const Filter& filter, const Map& map, int plane_entry, const Vec3& origin_W, const Vec3& direction_W,
                Scalar* range);

/// The first wall that a ray meets, not counting rejected ones; -1: none. *range as above; untouched where there is none.
int first_wall(const Filter& filter, const Map& map, const Vec3& origin_W, const Vec3& direction_W, Scalar* range);

/// Distance along a ray to a wall of the plan, in lengths of direction_W; zero where it has none there. The wall's place is that of the
/// plan, even where the filter has moved or rejected the wall.
Scalar range_in_plan(const Filter& filter, const Map& map, const Vec3& origin_W, const Vec3& direction_W);

}  // namespace pf
