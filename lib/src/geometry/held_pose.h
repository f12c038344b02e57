#pragma once

#include "geometry/plane.h"

namespace pf {

/// A pose A that a camera V holds, which may lie on a plane, and its Jacobians.
///
///   R_0 = R_V R_VA,   p_0 = p_V + R_V p_VA                        as V holds it
///
/// and on a plane with the normal n, where the ray of V through p_0 meets it, with its third axis along the normal:
///
///   p_A = p_V + t R_V p_VA,   R_A = Q R_0        Q: the smallest rotation that takes R_0 e_z to n, or to -n where that is nearer
///
///   errors (theta, p) in W:   R_true = Exp(theta) R,   p_true = p + e_p
///   held:       theta_A = theta_V,   e_A = e_V - [p_A - p_V]x theta_V
///   on a plane: theta_A = n nᵀ theta_V + n x dn,   e_A by intersect_ray_plane        where R_0 e_z is about n
///
/// J_V 6x6 by (theta, p) of V; J_plane 6x3 by (a, b, h); J_ray 3x3: of p_A by the direction of the ray in W, R_V p_VA. Where it
/// is held the last two are zero. lib/docs/theory/anchors.md
struct HeldPose {
  using Mat63 = Eigen::Matrix<Scalar, 6, 3>;

  Quat q_WA = Quat::Identity();
  Vec3 p_WA = Vec3::Zero();
  Mat6 J_V = Mat6::Zero();
  Mat63 J_plane = Mat63::Zero();
  Mat3 J_ray = Mat3::Zero();
};

/// A pose relative to another one.
struct RelativePlace {
  Quat q = Quat::Identity();
  Vec3 p = Vec3::Zero();

  RelativePlace of(const RelativePlace& inner) const { return {(q * inner.q).normalized(), p + q * inner.p}; }
  RelativePlace inverse() const { return {q.conjugate(), -(q.conjugate() * p)}; }
};

HeldPose held_pose(const RelativePlace& T_WV, const RelativePlace& T_VA);
/// False where the ray does not meet the plane (intersect_ray_plane); *out is untouched then.
bool held_pose_on(const RelativePlace& T_WV, const RelativePlace& T_VA, const PlaneFrame& frame, const Vec3& x,
                  HeldPose* out);

/// The rotation R_VA that a pose on a plane has at first: its third axis is the normal n_V, and its first one that of the camera as far as
/// the plane allows, or its second one where the plane is seen along the first.
Quat upright_on(const Vec3& n_V);

}  // namespace pf
