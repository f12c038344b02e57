#include "window/rotation_fit.h"

#include <algorithm>

#include "geometry/so3.h"
#include "window/tuning.h"

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

}  // namespace pf
