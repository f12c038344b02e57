#include "observe/point.h"

#include "geometry/so3.h"

namespace pf {

bool observe_point(const Camera& lens, const CameraAt& camera, const Vec3& f_W, Vec2* z, Mat26* J_z_camera,
                   Mat23* J_z_point) {
  const Mat3 R_CW = camera.q_WC.toRotationMatrix().transpose();
  const Vec3 d_W = f_W - camera.p_W;
  Mat23 J_z_C;
  if (!project(lens, R_CW.lazyProduct(d_W), z, &J_z_C)) return false;
  const Mat23 J_z_W = J_z_C.lazyProduct(R_CW);
  J_z_camera->leftCols<3>() = J_z_W.lazyProduct(hat(d_W));
  J_z_camera->rightCols<3>() = -J_z_W;
  *J_z_point = J_z_W;
  return true;
}

}  // namespace pf
