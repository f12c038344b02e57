#pragma once

#include "base/eigen.h"

/// Rotations. Errors are on the world side: R_true = Exp(theta) R.

namespace pf {

/// [a]x b = a x b.
Mat3 hat(const Vec3& a);

/// Rotation vector [rad] to unit quaternion; any angle.
Quat exp_so3(const Vec3& theta);

/// Unit quaternion to rotation vector [rad], angle in [0, pi].
Vec3 log_so3(const Quat& q);

/// Shortest rotation that takes the z axis to the unit vector b: (1 + b_z, z x b), normalised. Where b is almost -z, half a turn about x,
/// one of many.
Quat turn_z_to(const Vec3& b);

/// Left Jacobian: Exp(phi + d) = Exp(J_l(phi) d) Exp(phi) to first order; any angle.
Mat3 left_jacobian_so3(const Vec3& phi);

}  // namespace pf
