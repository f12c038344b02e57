#include "geometry/held_pose.h"

#include <cmath>

#include "geometry/ray_plane.h"
#include "geometry/so3.h"

namespace pf {

HeldPose held_pose(const RelativePlace& T_WV, const RelativePlace& T_VA) {
  const RelativePlace T_WA = T_WV.of(T_VA);
  HeldPose out;
  out.q_WA = T_WA.q;
  out.p_WA = T_WA.p;
  out.J_V.setIdentity();
  out.J_V.bottomLeftCorner<3, 3>() = -hat(Vec3(T_WA.p - T_WV.p));
  return out;
}

bool held_pose_on(const RelativePlace& T_WV, const RelativePlace& T_VA, const PlaneFrame& frame, const Vec3& x,
                  HeldPose* out) {
  const Vec3 direction_W = T_WV.q * T_VA.p;
  Vec3 at;
  Mat3 J_origin, J_direction, J_plane;
  if (!intersect_ray_plane(frame, x, T_WV.p, direction_W, &at, &J_origin, &J_direction, &J_plane)) return false;
  Vec3 n_W;
  Scalar d_W;
  Mat3 J_n_x;
  plane_normal(frame, x, &n_W, &d_W, &J_n_x);
  const Quat q_0 = (T_WV.q * T_VA.q).normalized();
  const Vec3 z_0 = q_0 * Vec3::UnitZ();
  if (z_0.dot(n_W) < Scalar(0)) {
    n_W = -n_W;
    J_n_x = -J_n_x;
  }
  Quat Q(1 + z_0.dot(n_W), 0, 0, 0);
  Q.vec() = z_0.cross(n_W);
  out->q_WA = (Q.normalized() * q_0).normalized();
  out->p_WA = at;
  out->J_V.setZero();
  out->J_V.topLeftCorner<3, 3>() = n_W * n_W.transpose();
  out->J_V.bottomLeftCorner<3, 3>() = -J_direction * hat(direction_W);
  out->J_V.bottomRightCorner<3, 3>() = J_origin;
  out->J_plane.topRows<3>() = hat(n_W) * J_n_x;
  out->J_plane.bottomRows<3>() = J_plane;
  out->J_ray = J_direction;
  return true;
}

Quat upright_on(const Vec3& n_V) {
  constexpr Scalar kAlong = Scalar(0.9);
  const Vec3 axis = std::abs(n_V.x()) < kAlong ? Vec3::UnitX() : Vec3::UnitY();
  Mat3 R_VA;
  R_VA.col(2) = n_V;
  R_VA.col(0) = (axis - n_V * n_V.dot(axis)).normalized();
  R_VA.col(1) = n_V.cross(R_VA.col(0));
  return Quat(R_VA).normalized();
}

}  // namespace pf
