#include "filter_slam/features/wall_rays.h"

namespace pf {

bool meets_wall(const Filter& filter, const Map& map, int plane_entry, const Vec3& origin_W, const Vec3& direction_W,
                Scalar* range) {
  const PlaneEntry& wall = map.planes[plane_entry];
  const PlaneAt at = FilterPlanes{filter, map}(plane_entry);
  return meets_outline(at, wall.two_sided, wall.support, origin_W, direction_W, range);
}

int first_wall(const Filter& filter, const Map& map, const Vec3& origin_W, const Vec3& direction_W, Scalar* range) {
  return find_first_wall(map.planes, FilterPlanes{filter, map}, origin_W, direction_W, range);
}

Scalar range_in_plan(const Filter& filter, const Map& map, const Vec3& origin_W, const Vec3& direction_W) {
  Scalar nearest = 0;
  for (int k = 0; k < map.planes.capacity(); ++k) {
    Scalar at = 0;
    if (!map.planes.used(k) || !map.planes[k].known) continue;
    const PlaneAt plan = {FilterPlanes{filter, map}(k).frame};
    if (!meets_outline(plan, map.planes[k].two_sided, map.planes[k].plan, origin_W, direction_W, &at)) continue;
    if (nearest == Scalar(0) || at < nearest) nearest = at;
  }
  return nearest;
}

}  // namespace pf
