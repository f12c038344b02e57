#pragma once

#include "filter/camera_at.h"

namespace pf {

/// Pixel of a 3-D point, and its Jacobians.
///
///   p_C = R_WC^T (f_W - p_WC),   z = pi(p_C)                    p_C in front of the camera
///   dp_C: theta  R^T [f - p]x,   p  -R^T,   f  R^T
///
/// J_z_camera 2x6 of (theta, p), J_z_point 2x3. False when the point does not project; outputs are then undefined.
/// src Gee 2007 (2); rotation error on the world side.
inline bool observe_point(const Camera& lens, const CameraAt& camera, const Vec3& f_W, Vec2* z, Mat26* J_z_camera,
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
