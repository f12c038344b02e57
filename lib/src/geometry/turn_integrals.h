#pragma once

#include "base/eigen.h"

namespace pf {

/// An integral along a rotation by phi [rad], any angle (lib/docs/theory/servant2008.md):
///
///   M(phi) = I + b hat(phi) + c hat(phi)^2
struct TurnIntegral {
  Vec3 phi;
  Scalar b, c;
  Scalar db, dc;  ///< (db/da) / a and (dc/da) / a, a = |phi|

  Mat3 matrix() const;
  /// d(M(phi) x) / dphi.
  Mat3 by_phi(const Vec3& x) const;
};

/// S(phi) = int_0^1 Exp(s phi) ds, which is the left Jacobian.                                    src Servant 2008 (3)
TurnIntegral turn_integral(const Vec3& phi);

/// T(phi) = 2 int_0^1 s Exp(s phi) ds.   src Servant 2008 (3): there 2 int_0^1 (1 - s) Exp(-s phi) ds, which is the same from
/// the end of the rotation, Exp(-phi) T(phi)
TurnIntegral turn_integral_of_ramp(const Vec3& phi);

}  // namespace pf
