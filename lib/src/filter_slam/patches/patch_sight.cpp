#include <algorithm>
#include <cmath>

#include "filter_slam/features/wall_rays.h"
#include "filter_slam/patches/patch_keeper.h"
#include "filter_slam/patches/tuning.h"
#include "geometry/homography.h"
#include "geometry/small_cholesky.h"
#include "model/camera_at.h"
#include "model/reference_camera.h"
#include "observe/ray_point.h"

/// Where the filter expects a patch.

namespace pf {

using namespace tuning::patch_keeper;

namespace {

/// Of a patch's corners by the pose.
Eigen::Matrix<Scalar, 8, 6> pose_jacobian(const PatchMeasurement& z) {
  Eigen::Matrix<Scalar, 8, 6> J;
  const int columns = z.H.columns();
  for (int a = 0; a < J.rows(); ++a)
    for (int c = 0; c < J.cols(); ++c) J(a, c) = z.H.h[a * columns + c];
  return J;
}

}  // namespace

/// False where a corner cannot be projected.
bool PatchKeeper::expect(const StoredPatch& patch, int wall, Sight* sight) const {
  using model::ReferenceCamera;
  const State& state = filter_.state();
  const Camera& lens = filter_.lens();
  const Block &reference = state.block[patch.camera], &plane = state.block[map_.planes[wall].slot];
  const PlaneFrame& frame = state.frame_of(plane);
  const bool rolls = lens.readout != Scalar(0) && state.layout.has(BodyPart::kVelocity);
  Vec3 from[4], to[4];
  sight->middle_W.setZero();
  for (int k = 0; k < 4; ++k) {
    RayPoint point;
    CameraAt camera = camera_at(state, Scalar(0));
    for (int round = 0; round < (rolls ? 3 : 1); ++round) {
      if (round > 0) camera = camera_at(state, row_time(lens, point.z.y()));
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
  if (map_.planes[wall].two_sided) sight->cosine = std::abs(sight->cosine);
  return homography_from_4(from, to, &sight->H_CK);
}

/// Whether the patch's middle is in the image, and not too slanted.
bool PatchKeeper::is_in_view(const Sight& sight) const {
  const Vec2 middle = (sight.corner[0] + sight.corner[1] + sight.corner[2] + sight.corner[3]) / 4;
  const Camera& lens = filter_.lens();
  return sight.cosine > kMinCosine && middle.x() > Scalar(0) && middle.y() > Scalar(0) &&
         middle.x() < static_cast<Scalar>(lens.width) && middle.y() < static_cast<Scalar>(lens.height);
}

/// The wall that the plan has between the camera and a patch on another one, or -1.
int PatchKeeper::hiding_wall(int wall, const Sight& sight) const {
  const Vec3& c_W = filter_.state().body.p_W;
  Scalar range = 0;  // relative to the patch's own
  const int first = first_wall(filter_, map_, c_W, sight.middle_W - c_W, &range);
  return first == wall || range > Scalar(1) ? -1 : first;
}

/// The same homography, with a shift in the image behind it.
bool PatchKeeper::move_to(const StoredPatch& patch, const Vec2& shift, Sight* sight) const {
  Vec3 from[4], to[4];
  for (int k = 0; k < 4; ++k) {
    sight->corner[k] += shift;
    if (!unproject(filter_.lens(), patch.pixels.corner(k), &from[k]) ||
        !unproject(filter_.lens(), sight->corner[k], &to[k]))
      return false;
  }
  return homography_from_4(from, to, &sight->H_CK);
}

void PatchKeeper::set_pose(const Body& pose) {
  Body body = filter_.state().body;
  body.q_WC = pose.q_WC;
  body.p_W = pose.p_W;
  filter_.set_mean(body);
}

/// Prediction of a patch's corners for the estimate, linearised at another pose: h(x) + H (x^ [-] x).
bool PatchKeeper::predict_near(const StoredPatch& patch, int plane, const Body& near, PatchMeasurement* z) {
  const Body estimate = filter_.state().body;
  set_pose(near);
  const bool ok = filter_.predict_patch(filter_.lens(), patch.block, plane, patch.reference_px, z);
  set_pose(estimate);
  Vec6 e;
  e << log_so3(estimate.q_WC * near.q_WC.conjugate()), estimate.p_W - near.p_W;
  if (ok) z->predicted += pose_jacobian(*z).lazyProduct(e);
  return ok;
}

/// Prediction and Jacobian of a patch that is far from where it was expected, at the pose that the prior and its corners make most likely:
///
///   z = h(x_k) + H (x [-] x_k),   x_k+1 = x^ [+] P H^T (H P H^T + R)^-1 (z - h(x_k) - H (x^ [-] x_k))      over the pose alone
///
/// so that the prediction at the estimate is h(x_k) + H (x^ [-] x_k). near gets x_k. src  Bell and Cathey 1993
bool PatchKeeper::linearise_near(const StoredPatch& patch, int plane, Body* near) {
  const Body estimate = filter_.state().body;
  Body at = estimate;
  Scalar covariance[Body::kPoseDim * Body::kPoseDim];
  filter_.body_covariance(Body::kPoseDim, covariance);
  const Mat6 P = Eigen::Map<const Mat6>(covariance);
  const Vec8 measured = z_.measured;
  bool ok = true;
  for (int step = 0;; ++step) {
    ok = predict_near(patch, plane, at, &z_);
    if (!ok || step == kPoseSteps) break;
    const Eigen::Matrix<Scalar, 8, 6> J = pose_jacobian(z_);
    const Eigen::Matrix<Scalar, 6, 8> PJ = P.lazyProduct(J.transpose());
    SmallCholesky<8> cholesky;
    ok = cholesky.factor(J.lazyProduct(PJ) + z_.R_gate + Mat8(Mat8::Identity() * (kPoseSigma * kPoseSigma)));
    if (!ok) break;
    const Vec6 d = PJ.lazyProduct(cholesky.solve<1>(measured - z_.predicted));
    at.q_WC = exp_so3(Vec3(d.head<3>())) * estimate.q_WC;
    at.q_WC.normalize();
    at.p_W = estimate.p_W + d.tail<3>();
  }
  z_.measured = measured;
  *near = at;
  return ok;
}

}  // namespace pf
