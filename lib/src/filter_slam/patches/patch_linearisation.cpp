#include "filter_slam/patches/patch_linearisation.h"

#include "filter_slam/patches/tuning.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"

namespace pf {
namespace {

using namespace tuning::patch_keeper;

/// Of a patch's corners by the pose.
Eigen::Matrix<Scalar, 8, 6> pose_jacobian(const PatchMeasurement& z) {
  Eigen::Matrix<Scalar, 8, 6> J;
  const int columns = z.H.columns();
  for (int a = 0; a < J.rows(); ++a)
    for (int c = 0; c < J.cols(); ++c) J(a, c) = z.H.h[a * columns + c];
  return J;
}

}  // namespace

void set_camera_pose(Filter& filter, const Body& pose) {
  Body body = filter.state().body;
  body.q_WC = pose.q_WC;
  body.p_W = pose.p_W;
  filter.set_mean(body);
}

bool predict_patch_near(Filter& filter, const StoredPatch& patch, int plane, const Body& near, PatchMeasurement* z) {
  const Body estimate = filter.state().body;
  set_camera_pose(filter, near);
  const bool ok = filter.predict_patch(filter.lens(), patch.block, plane, patch.reference_px, z);
  set_camera_pose(filter, estimate);
  Vec6 e;
  e << log_so3(estimate.q_WC * near.q_WC.conjugate()), estimate.p_W - near.p_W;
  if (ok) z->predicted += pose_jacobian(*z).lazyProduct(e);
  return ok;
}

bool linearise_patch_near(Filter& filter, const StoredPatch& patch, int plane, PatchMeasurement* z, Body* near) {
  using Mat8 = PatchMeasurement::Matrix;
  const Body estimate = filter.state().body;
  Body at = estimate;
  Scalar covariance[Body::kPoseDim * Body::kPoseDim];
  filter.body_covariance(Body::kPoseDim, covariance);
  const Mat6 P = Eigen::Map<const Mat6>(covariance);
  bool ok = true;
  for (int step = 0;; ++step) {
    ok = predict_patch_near(filter, patch, plane, at, z);
    if (!ok || step == kPoseSteps) break;
    const Eigen::Matrix<Scalar, 8, 6> J = pose_jacobian(*z);
    const Eigen::Matrix<Scalar, 6, 8> PJ = P.lazyProduct(J.transpose());
    SmallCholesky<8> cholesky;
    ok = cholesky.factor(J.lazyProduct(PJ) + z->R_gate + Mat8(Mat8::Identity() * (kPoseSigma * kPoseSigma)));
    if (!ok) break;
    const Vec6 d = PJ.lazyProduct(cholesky.solve<1>(z->measured - z->predicted));
    at.q_WC = exp_so3(Vec3(d.head<3>())) * estimate.q_WC;
    at.q_WC.normalize();
    at.p_W = estimate.p_W + d.tail<3>();
  }
  *near = at;
  return ok;
}

}  // namespace pf
