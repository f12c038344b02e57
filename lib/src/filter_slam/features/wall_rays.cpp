#include "filter_slam/features/wall_rays.h"

#include "geometry/ray_plane.h"

namespace pf {
namespace {

/// Whether a ray meets a wall inside of an outline of it, on a side that can be seen, for a plane (a, b, h) about its frame.
bool meets(const PlaneEntry& wall, const PlaneOutline& outline, const PlaneFrame& frame, const Vec3& plane,
           const Vec3& origin_W, const Vec3& direction_W, Scalar* range) {
  Vec3 hit_W;
  if (!wall.two_sided && !(plane_distance(frame, plane, origin_W) > Scalar(0))) return false;
  if (!intersect_ray_plane(frame, plane, origin_W, direction_W, &hit_W)) return false;
  if (!outline_contains(outline, plane_coordinates(frame, hit_W))) return false;
  *range = (hit_W - origin_W).norm() / direction_W.norm();
  return true;
}

}  // namespace

bool meets_wall(const Filter& filter, const Map& map, int plane_entry, const Vec3& origin_W, const Vec3& direction_W,
                Scalar* range) {
  const PlaneEntry& wall = map.planes[plane_entry];
  const Block& block = filter.state().block[wall.slot];
  return meets(wall, wall.support, filter.state().frame_of(block), block.xyz(), origin_W, direction_W, range);
}

int first_wall(const Filter& filter, const Map& map, const Vec3& origin_W, const Vec3& direction_W, Scalar* range) {
  int first = -1;
  for (int k = 0; k < map.planes.capacity(); ++k) {
    Scalar at = 0;
    if (!map.planes.used(k) || !map.planes[k].known || !map.planes[k].counts()) continue;
    if (!meets_wall(filter, map, k, origin_W, direction_W, &at) || (first >= 0 && at >= *range)) continue;
    first = k;
    *range = at;
  }
  return first;
}

Scalar range_in_plan(const Filter& filter, const Map& map, const Vec3& origin_W, const Vec3& direction_W) {
  Scalar nearest = 0;
  for (int k = 0; k < map.planes.capacity(); ++k) {
    Scalar at = 0;
    if (!map.planes.used(k) || !map.planes[k].known) continue;
    const PlaneFrame& frame = filter.state().frame_of(filter.state().block[map.planes[k].slot]);
    if (!meets(map.planes[k], map.planes[k].plan, frame, Vec3::Zero(), origin_W, direction_W, &at)) continue;
    if (nearest == Scalar(0) || at < nearest) nearest = at;
  }
  return nearest;
}

}  // namespace pf
