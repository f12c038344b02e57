#include "bundle/rotation_fit.h"

#include <algorithm>

#include "bundle/bearing.h"
#include "bundle/tuning.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"

namespace pf {

Scalar fit_rotation(const Camera& camera, const Vec3* ray, const BundlePixel* pixel, int count, Scalar* scratch,
                    Quat* q_WC) {
  using namespace tuning::start;
  Scalar scale = kFirstRotationScale;  // tightens as the rotation is found
  int used = 0;
  for (int round = 0; round < kPoseRounds; ++round) {
    Mat3 H = Mat3::Identity() * kStepRegularisation;
    Vec3 g = Vec3::Zero();
    const Mat3 R_WC = q_WC->toRotationMatrix();
    used = 0;
    for (int i = 0; i < count; ++i) {
      if (!pixel[i].seen) continue;
      Vec2 z;
      Mat26 J_z_C;
      if (!project_bearing(camera, R_WC, ray[i], Vec3::Zero(), Scalar(0), &z, &J_z_C)) continue;
      const Vec2 r = pixel[i].pixel() - z;
      scratch[used++] = r.norm();
      const Scalar w = Scalar(1) / (Scalar(1) + r.squaredNorm() / (scale * scale));
      const Mat23 J = J_z_C.leftCols<3>();
      H += w * J.transpose().lazyProduct(J);
      g += w * J.transpose().lazyProduct(r);
    }
    if (used == 0) return Scalar(0);
    const Mat3 inverse = H.inverse();
    *q_WC = exp_so3(inverse.lazyProduct(g)) * *q_WC;
    q_WC->normalize();
    std::nth_element(scratch, scratch + used / 2, scratch + used);
    scale = std::max(Scalar(1), Scalar(2) * scratch[used / 2]);
  }
  return scratch[used / 2];
}

bool translation_left(const Camera& camera, const Vec3* ray, const BundlePixel* pixel, int count, const Quat& q_WC,
                      Mat3* A) {
  Mat3 H_rr = Mat3::Identity() * tuning::start::kStepRegularisation, H_rt = Mat3::Zero(), H_tt = Mat3::Zero();
  const Mat3 R_WC = q_WC.toRotationMatrix();
  int used = 0;
  for (int i = 0; i < count; ++i) {
    Vec2 z;
    Mat26 J_z_C;
    if (!pixel[i].seen || !project_bearing(camera, R_WC, ray[i].normalized(), Vec3::Zero(), Scalar(1), &z, &J_z_C))
      continue;
    const Mat23 J_r = J_z_C.leftCols<3>(), J_t = J_z_C.rightCols<3>();
    H_rr += J_r.transpose().lazyProduct(J_r);
    H_rt += J_r.transpose().lazyProduct(J_t);
    H_tt += J_t.transpose().lazyProduct(J_t);
    ++used;
  }
  SmallCholesky<3> cholesky;
  if (used == 0 || !cholesky.factor(H_rr)) return false;
  *A = (H_tt - H_rt.transpose().lazyProduct(cholesky.solve<3>(H_rt))) / static_cast<Scalar>(used);
  return true;
}

}  // namespace pf
