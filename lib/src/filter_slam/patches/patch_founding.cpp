#include <algorithm>
#include <cmath>

#include "filter_slam/patches/patch_keeper.h"
#include "filter_slam/patches/tuning.h"
#include "geometry/ray_plane.h"
#include "geometry/small_cholesky.h"
#include "geometry/two_view_plane.h"
#include "model/camera_at.h"
#include "model/reference_camera.h"

/// A patch that no plane of the map explains founds one (lib/docs/walls.md).

namespace pf {
namespace {

using namespace tuning::patch_founding;
using model::ReferenceCamera;

}  // namespace

/// The plane that its corners lie on, as its reference camera and this frame saw them; range: of its middle, from the camera now.
/// m: n / d in the reference camera, zero where the views do not tell it.
bool PatchKeeper::fit_plane_to(const StoredPatch& patch, PlaneFit* fit, Scalar* range, Vec3* m) const {
  const State& state = filter_.state();
  const Camera& lens = filter_.lens();
  const Block& reference = state.block[patch.camera];
  const Quat q_WK = ReferenceCamera::q_WC(reference);
  const Vec3 p_WK = ReferenceCamera::p_WC(reference);
  const bool rolls = lens.readout != Scalar(0) && state.layout.has(BodyPart::kVelocity);
  Vec3 ray_K[4], ray_C[4], t_CK[4], corner_W[4];
  Mat3 R_CK[4];
  for (int k = 0; k < 4; ++k) {
    const CameraAt camera = camera_at(state, rolls ? row_time(lens, patch.corner[k].y()) : Scalar(0));
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

/// Two views do not tell a plane that stands still from what moves or is no plane: what they say must hold some frames later.
void PatchKeeper::note_plane(StoredPatch* patch) const {
  PlaneFit fit;
  Scalar range;
  fit_plane_to(*patch, &fit, &range, &patch->early_plane);
}

/// Whether the corners tell enough of a plane that has this prior, on which nothing else depends: P_left = P - P H^T S^-1 H P over its
/// three rows. Asked before they are taken in, since a prior that nothing takes back says where the world is.
bool PatchKeeper::would_tell(const StoredPatch& patch, int plane, const Mat3& prior) {
  SmallCholesky<8> cholesky;
  if (!filter_.predict_patch(filter_.lens(), patch.block, plane, patch.reference_px, &z_)) return false;
  put_measured(patch);
  if (!cholesky.factor(filter_.covariance_of<8>(z_.H) + z_.R_update)) return false;
  const int columns = z_.H.columns(), at = z_.H.part[0].size + z_.H.part[1].size;
  for (int i = 0; i < prior.cols(); ++i) {
    Vec8 HP = Vec8::Zero();
    for (int a = 0; a < z_.kHeight; ++a)
      for (int c = 0; c < prior.rows(); ++c) HP(a) += z_.H.h[a * columns + at + c] * prior(c, i);
    if (!(prior(i, i) - HP.dot(cholesky.solve<1>(HP)) < kMinLearnt * kMinLearnt * prior(i, i))) return false;
  }
  return true;
}

/// A plane with a wide prior, which this frame's corners are taken in on. Then the prior is taken back, so that what remains of the plane
/// is what the patch says with all that this depends on. False where that is too little, or no plane explains the corners.
bool PatchKeeper::found_plane(StoredPatch* patch) {
  constexpr int kRows = 3;
  PlaneFit fit;
  Scalar range;
  Vec3 m;
  if (!settings_.planes || filter_.state().planes >= filter_.state().max_planes ||
      !fit_plane_to(*patch, &fit, &range, &m) || !((m - patch->early_plane).norm() < kMaxChange * m.norm()) ||
      (filter_.room() < kRows && !features_.make_rows(kRows, frame_.report.t_ns)))
    return false;
  const Scalar sigma[kRows] = {kPriorSlope, kPriorSlope, kPriorRange * range};
  Mat3 prior = Mat3::Zero();
  for (int i = 0; i < kRows; ++i) prior(i, i) = sigma[i] * sigma[i];
  const int slot = filter_.add_known_plane(fit.frame, prior, settings_.fold.roughness);
  if (slot < 0) return false;
  const int entry = map_.planes.add(slot);
  filter_.set_owner(slot, entry);
  map_.planes[entry].roughness = settings_.fold.roughness;
  const bool told = would_tell(*patch, slot, prior);
  if (told) join(patch, entry);
  if (told && patch->status == PatchStatus::kInlier && filter_.forget_prior(slot, prior, kWidening)) {
    settings_.hooks.say("found a plane by a patch that no wall explains");
    return true;
  }
  filter_.remove(&slot, 1);
  map_.planes.remove(entry);
  return false;
}

/// Founds a plane where there is enough parallax, 10 frames after the plane was noted; waits for that, but not for ever.
void PatchKeeper::found_or_wait(StoredPatch* patch) {
  constexpr int kEvery = tuning::patch_waiting::kFoundEvery;
  const int frames = patch->wait.frames_without(), phase = frames % kEvery;
  if (phase == 0) note_plane(patch);
  const bool may_found = phase == kEvery / 2 && has_parallax(*patch, kFoundingParallax);
  if (may_found ? !found_plane(patch) : frames >= kMaxFrames) give_up(patch);
}

/// The patch is a part of the plane.
void PatchKeeper::extend_plane(const StoredPatch& patch, int entry) {
  const State& state = filter_.state();
  const Block& plane = state.block[map_.planes[entry].slot];
  const Block& camera = state.block[patch.camera];
  Vec2 uv[4];
  for (int k = 0; k < 4; ++k) {
    Vec3 ray_K, hit_W;
    if (!unproject(filter_.lens(), patch.reference_px[k], &ray_K) ||
        !intersect_ray_plane(state.frame_of(plane), plane.xyz(), ReferenceCamera::p_WC(camera),
                             ReferenceCamera::q_WC(camera) * ray_K, &hit_W))
      return;
    uv[k] = plane_coordinates(state.frame_of(plane), hit_W);
  }
  extend_outline(&map_.planes[entry].seen, uv, 4);
  extend_outline(&map_.planes[entry].support, uv, 4);
}

}  // namespace pf
