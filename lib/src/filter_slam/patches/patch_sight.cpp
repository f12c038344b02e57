#include "filter_slam/patches/patch_sight.h"

#include <algorithm>
#include <cmath>

#include "filter_slam/features/wall_rays.h"
#include "filter_slam/patches/tuning.h"
#include "geometry/homography.h"
#include "geometry/ray_plane.h"
#include "model/camera_at.h"
#include "model/reference_camera.h"
#include "observe/ray_point.h"

namespace pf {

bool expect_patch(const Filter& filter, const PlaneTable& planes, const StoredPatch& patch, int wall,
                  PatchSight* sight) {
  using model::ReferenceCamera;
  const State& state = filter.state();
  const Camera& lens = filter.lens();
  const Block &reference = state.block[patch.camera], &plane = state.block[planes[wall].slot];
  const PlaneFrame& frame = state.frame_of(plane);
  const int rounds = rows_roll(state, lens) ? 3 : 1;  // the time of a corner's row depends on where it is
  Vec3 from[4], to[4];
  sight->middle_W.setZero();
  for (int k = 0; k < 4; ++k) {
    RayPoint point;
    CameraAt camera = camera_at(state, Scalar(0));
    for (int round = 0; round < rounds; ++round) {
      if (round > 0) camera = camera_of_row(state, lens, point.z.y());
      if (!point.observe(lens, camera, ReferenceCamera::q_WC(reference), ReferenceCamera::p_WC(reference), frame,
                         plane.xyz(), patch.reference_px[k], false))
        return false;
    }
    Vec3 ray, hit_W;
    sight->corner[k] = point.z;
    if (!unproject(lens, patch.pixels.corner(k), &from[k]) || !unproject(lens, point.z, &to[k]) ||
        !unproject(lens, patch.reference_px[k], &ray) || !(from[k].z() > Scalar(0)))
      return false;
    if (!intersect_ray_plane(frame, plane.xyz(), ReferenceCamera::p_WC(reference),
                             ReferenceCamera::q_WC(reference) * ray, &hit_W))
      return false;
    sight->middle_W += hit_W / 4;
  }
  Vec3 n_W;
  Scalar d_W;
  plane_normal(frame, plane.xyz(), &n_W, &d_W);
  const Vec3 ray_W = state.body.p_W - sight->middle_W;
  sight->cosine = n_W.dot(ray_W) / ray_W.norm();
  if (planes[wall].two_sided) sight->cosine = std::abs(sight->cosine);
  return homography_from_4(from, to, &sight->H_CK);
}

bool fit_homography(const Camera& lens, const PlanePatch& pixels, PatchSight* sight) {
  Vec3 from[4], to[4];
  for (int k = 0; k < 4; ++k)
    if (!unproject(lens, pixels.corner(k), &from[k]) || !unproject(lens, sight->corner[k], &to[k])) return false;
  return homography_from_4(from, to, &sight->H_CK);
}

bool is_in_view(const Camera& lens, const PatchSight& sight) {
  return sight.cosine > tuning::patch_keeper::kMinCosine && is_in_image(lens, middle_of(sight.corner));
}

bool is_whole_in_view(const Camera& lens, const PatchSight& sight) {
  return std::all_of(sight.corner, sight.corner + 4, [&](const Vec2& at) { return is_in_image(lens, at); });
}

int hiding_wall(const Filter& filter, const Map& map, int wall, const PatchSight& sight) {
  const Vec3& c_W = filter.state().body.p_W;
  Scalar range = 0;  // relative to the patch's own
  const int first = first_wall(filter, map, c_W, sight.middle_W - c_W, &range);
  return first == wall || range > Scalar(1) ? -1 : first;
}

}  // namespace pf
