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
  return find_range_in_plan(
      map.planes,
      [&](int k) {
        return FilterPlanes{filter, map}(k).frame;
      },
      origin_W, direction_W);
}

}  // namespace pf
