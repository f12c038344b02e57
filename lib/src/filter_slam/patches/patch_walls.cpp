#include "filter_slam/patches/patch_walls.h"

#include <cmath>

#include "filter_slam/features/wall_rays.h"
#include "filter_slam/patches/patch_sight.h"
#include "filter_slam/patches/patch_views.h"
#include "filter_slam/patches/tuning.h"
#include "geometry/common_ratio.h"
#include "geometry/ray_plane.h"
#include "model/camera_at.h"
#include "model/reference_camera.h"

namespace pf {
namespace {

using namespace tuning::patch_waiting;
using model::ReferenceCamera;

constexpr int kMaxMost = 128;  // points that are used

}  // namespace

int wall_of(const PlaneTable& planes, const StoredPatch& patch) {
  const int entry = planes.entry_of(planes.find(patch.plane));
  return entry >= 0 && planes[entry].counts() ? entry : -1;
}

bool is_known_by_plan_alone(const Filter& filter, const PlaneEntry& wall) {
  return wall.known && wall.upheld == 0 && filter.state().block[wall.slot].children == 0;
}

bool may_lie_on(const Filter& filter, const Map& map, const StoredPatch& patch, int entry, Scalar* range) {
  const PlaneEntry& plane = map.planes[entry];
  if (!map.planes.used(entry) || !plane.counts()) return false;
  const State& state = filter.state();
  const Block& camera = state.block[patch.camera];
  Vec3 ray_K;
  if (!unproject(filter.lens(), middle_of(patch.reference_px), &ray_K)) return false;
  const Vec3 p_W = ReferenceCamera::p_WC(camera), ray_W = ReferenceCamera::q_WC(camera) * ray_K;
  if (plane.known) return meets_wall(filter, map, entry, p_W, ray_W, range);
  const Block& block = state.block[plane.slot];
  const PlaneFrame& frame = state.frame_of(block);
  Vec3 hit_W;
  if (plane.support.count < 3 || !(plane_distance(frame, block.xyz(), p_W) > Scalar(0)) ||
      !intersect_ray_plane(frame, block.xyz(), p_W, ray_W, &hit_W))
    return false;
  *range = (hit_W - p_W).norm() / ray_W.norm();
  return outline_contains(plane.support, plane_coordinates(frame, hit_W),
                          kReach * std::sqrt(outline_area(plane.support)));
}

bool range_ratio(const Filter& filter, const Map& map, const StoredPatch& patch, const Vec3& m, int entry,
                 Scalar* ratio) {
  Vec3 ray_K;
  Scalar range = 0;
  if (!unproject(filter.lens(), middle_of(patch.reference_px), &ray_K) ||
      !may_lie_on(filter, map, patch, entry, &range))
    return false;
  *ratio = range * m.dot(ray_K) / ray_K.norm();
  return *ratio > Scalar(0);
}

bool is_before_another(const Filter& filter, const Map& map, const PatchStore& store, const StoredPatch& patch,
                       int entry) {
  Scalar own, other;
  if (!is_known_by_plan_alone(filter, map.planes[entry]) ||
      !range_ratio(filter, map, patch, patch.last_plane, entry, &own))
    return false;
  for (int i = 0; i < store.capacity(); ++i) {
    const StoredPatch& another = store[i];
    if (!store.used(i) || another.id == patch.id || !another.wait.waits() || !another.was_found()) continue;
    if (another.wait.passes(map.planes[entry].id) &&
        range_ratio(filter, map, another, another.last_plane, entry, &other) && own > kFromMost * other)
      return true;
  }
  return false;
}

bool is_off_most_points(const Filter& filter, const Map& map, std::int64_t t_ns, const StoredPatch& patch, int entry) {
  const State& state = filter.state();
  if (!is_known_by_plan_alone(filter, map.planes[entry])) return false;
  const CameraAt camera = camera_at(state, Scalar(0));
  Scalar ratio[kMaxMost], range = 0, of_patch = 0;
  int count = 0;
  for (int i = 0; i < map.features.capacity() && count < kMaxMost; ++i) {
    if (!map.features.used(i) || map.features[i].last_seen_ns != t_ns) continue;
    const int slot = map.features[i].slot;
    if (state.block[slot].kind == BlockKind::kPoint &&
        first_wall(filter, map, camera.p_W, filter.point(slot) - camera.p_W, &range) == entry)
      ratio[count++] = range;
  }
  const CommonRatio most = find_common_ratio(ratio, count, kMostWidth);
  if (most.votes < kMinMost || kMinVoting * most.votes < count) return false;
  PlaneFit fit;
  Vec3 m, ray_C, hit_W;
  if (!fit_plane_to(filter, patch, &fit, &of_patch, &m) || !unproject(filter.lens(), middle_of(patch.corner), &ray_C))
    return false;
  const Vec3 ray_W = camera.q_WC * ray_C;
  if (!meets_wall(filter, map, entry, camera.p_W, ray_W, &range) ||
      !intersect_ray_plane(fit.frame, Vec3(Vec3::Zero()), camera.p_W, ray_W, &hit_W))
    return false;
  of_patch = range * ray_W.norm() / (hit_W - camera.p_W).norm();
  return of_patch > kFromMost * most.ratio || most.ratio > kFromMost * of_patch;
}

bool is_seen_through(const Filter& filter, const Map& map, const StoredPatch& patch, int entry) {
  const int wall = patch.plane != 0 ? wall_of(map.planes, patch) : -1;
  Scalar to_wall, to_plane;
  return wall >= 0 && wall != entry && may_lie_on(filter, map, patch, wall, &to_wall) &&
         may_lie_on(filter, map, patch, entry, &to_plane) && to_plane > to_wall;
}

}  // namespace pf
