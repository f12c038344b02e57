#include "filter_slam/patches/patch_views.h"

#include "filter_slam/patches/tuning.h"
#include "geometry/ray_plane.h"
#include "geometry/two_view_plane.h"
#include "model/camera_at.h"
#include "model/reference_camera.h"

namespace pf {

using model::ReferenceCamera;

bool fit_plane_to(const Filter& filter, const StoredPatch& patch, PlaneFit* fit, Scalar* range, Vec3* m) {
  using tuning::patch_founding::kMinCosine;
  const State& state = filter.state();
  const Camera& lens = filter.lens();
  const Block& reference = state.block[patch.camera];
  const Quat q_WK = ReferenceCamera::q_WC(reference);
  const Vec3 p_WK = ReferenceCamera::p_WC(reference);
  Vec3 ray_K[4], ray_C[4], t_CK[4], corner_W[4];
  Mat3 R_CK[4];
  for (int k = 0; k < 4; ++k) {
    const CameraAt camera = camera_of_row(state, lens, patch.corner[k].y());
    if (!unproject(lens, patch.reference_px[k], &ray_K[k]) || !unproject(lens, patch.corner[k], &ray_C[k]))
      return false;
    R_CK[k] = (camera.q_WC.conjugate() * q_WK).toRotationMatrix();
    t_CK[k] = camera.q_WC.conjugate() * (p_WK - camera.p_W);
  }
  m->setZero();
  if (!two_view_plane(ray_K, ray_C, R_CK, t_CK, 4, m)) return false;
  Vec3 middle_W = Vec3::Zero();
  for (int k = 0; k < 4; ++k) {
    corner_W[k] = p_WK + q_WK * (ray_K[k] / m->dot(ray_K[k]));
    middle_W += corner_W[k] / 4;
  }
  if (!fit_plane(corner_W, 4, p_WK, fit)) return false;
  const Vec3 n_W = fit->frame.R_WP.col(2), view_W = state.body.p_W - middle_W, born_W = p_WK - middle_W;
  *range = view_W.norm();
  return n_W.dot(view_W) > kMinCosine * *range && n_W.dot(born_W) > kMinCosine * born_W.norm();
}

Scalar parallax_of(const Filter& filter, const StoredPatch& patch) {
  const Quat q_CK = filter.state().body.q_WC.conjugate() * ReferenceCamera::q_WC(filter.state().block[patch.camera]);
  Scalar sum = 0;
  for (int k = 0; k < 4; ++k) {
    Vec3 ray_K;
    Vec2 rotated;
    if (!unproject(filter.lens(), patch.reference_px[k], &ray_K) ||
        !project(filter.lens(), Vec3(q_CK * ray_K), &rotated))
      return Scalar(-1);
    sum += (patch.corner[k] - rotated).norm();
  }
  return sum / 4;
}

void extend_plane(const Filter& filter, const StoredPatch& patch, PlaneEntry* plane) {
  const State& state = filter.state();
  const Block &block = state.block[plane->slot], &camera = state.block[patch.camera];
  Vec2 uv[4];
  for (int k = 0; k < 4; ++k) {
    Vec3 ray_K, hit_W;
    if (!unproject(filter.lens(), patch.reference_px[k], &ray_K) ||
        !intersect_ray_plane(state.frame_of(block), block.xyz(), ReferenceCamera::p_WC(camera),
                             ReferenceCamera::q_WC(camera) * ray_K, &hit_W))
      return;
    uv[k] = plane_coordinates(state.frame_of(block), hit_W);
  }
  extend_outline(&plane->seen, uv, 4);
  extend_outline(&plane->support, uv, 4);
}

}  // namespace pf
