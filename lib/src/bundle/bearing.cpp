#include "bundle/bearing.h"

#include <algorithm>
#include <cmath>

#include "geometry/so3.h"

namespace pf {

/// Without a branch: which pixels are outliers cannot be predicted. sqrt(h h) is h, and 2 h r - h² <= r².
Scalar huber_cost(Scalar r2, Scalar huber, Scalar* weight) {
  const Scalar r = std::sqrt(std::max(r2, huber * huber));
  *weight = huber / r;
  return std::min(r2, Scalar(2) * huber * r - huber * huber);
}

bool project_bearing(const Camera& camera, const Mat3& R_WC, const Vec3& ray_W, const Vec3& p_HC_W, Scalar rho,
                     Vec2* pixel, Mat26* J_z_C, Mat26* J_z_H, Vec2* J_z_rho) {
  const Mat3 R_CW = R_WC.transpose();
  const Vec3 d = ray_W + rho * p_HC_W;
  if (J_z_C == nullptr) return project(camera, R_CW.lazyProduct(d), pixel);
  Mat23 J_z_d_C;
  if (!project(camera, R_CW.lazyProduct(d), pixel, &J_z_d_C)) return false;
  const Mat23 J_z_d = J_z_d_C.lazyProduct(R_CW);
  J_z_C->leftCols<3>() = J_z_d.lazyProduct(hat(d));
  J_z_C->rightCols<3>() = -rho * J_z_d;
  if (J_z_H != nullptr) {
    J_z_H->leftCols<3>() = -J_z_d.lazyProduct(hat(ray_W));
    J_z_H->rightCols<3>() = rho * J_z_d;
  }
  if (J_z_rho != nullptr) *J_z_rho = J_z_d.lazyProduct(p_HC_W);
  return true;
}

Scalar bearing_plane_distance(const BundlePlane& plane, const Vec3& ray_W, const Vec3& p_H, Scalar rho,
                              Mat13* J_e_plane, Mat16* J_e_H, Scalar* J_e_rho) {
  const Vec3 q = ray_W / rho;
  Mat13 n;
  const Scalar e = plane_distance(plane.frame, plane.x, p_H + q, J_e_plane, &n);
  if (J_e_H != nullptr) {
    J_e_H->leftCols<3>() = q.cross(n.transpose()).transpose();
    J_e_H->rightCols<3>() = n;
  }
  if (J_e_rho != nullptr) *J_e_rho = -n.dot(q) / rho;
  return e;
}

Scalar relative_plane_distance(const BundlePlane& plane, const Vec3& ray_W, const Vec3& p_H, Scalar rho,
                               Scalar rho_before, Mat13* J_e_plane, Mat16* J_e_H, Scalar* J_e_rho) {
  const Scalar e = bearing_plane_distance(plane, ray_W, p_H, rho, J_e_plane, J_e_H, J_e_rho);
  const Scalar ratio = rho / rho_before;
  if (J_e_plane != nullptr) *J_e_plane *= ratio;
  if (J_e_H != nullptr) *J_e_H *= ratio;
  if (J_e_rho != nullptr) *J_e_rho = ratio * *J_e_rho + e / rho_before;
  return ratio * e;
}

}  // namespace pf
