#include "geometry/turn_integrals.h"

#include <cmath>

#include "geometry/so3.h"

namespace pf {
namespace {

constexpr Scalar kSmall2 =
    Scalar(0.04);  // [rad^2] below this the quotients lose digits, and four terms of their series do not

/// k0 + k1 x + k2 x^2 + k3 x^3.
Scalar series(Scalar x, double k0, double k1, double k2, double k3) {
  return static_cast<Scalar>(k0) +
         x * (static_cast<Scalar>(k1) + x * (static_cast<Scalar>(k2) + x * static_cast<Scalar>(k3)));
}

}  // namespace

Mat3 TurnIntegral::matrix() const {
  const Mat3 h = hat(phi);
  return Mat3::Identity() + b * h + c * h.lazyProduct(h);
}

/// b hat(phi) x by phi: -b hat(x) + db (phi x x) phiᵀ; hat(phi)^2 x by phi: -(hat(phi x x) + hat(phi) hat(x)).
Mat3 TurnIntegral::by_phi(const Vec3& x) const {
  const Vec3 once = phi.cross(x), twice = phi.cross(once);
  const Vec3 along = db * once + dc * twice;
  return -b * hat(x) - c * (hat(once) + hat(phi).lazyProduct(hat(x))) + along.lazyProduct(phi.transpose());
}

TurnIntegral turn_integral(const Vec3& phi) {
  TurnIntegral m;
  m.phi = phi;
  const Scalar a2 = phi.squaredNorm();
  if (a2 < kSmall2) {
    m.b = series(a2, 1.0 / 2, -1.0 / 24, 1.0 / 720, -1.0 / 40320);
    m.c = series(a2, 1.0 / 6, -1.0 / 120, 1.0 / 5040, -1.0 / 362880);
    m.db = series(a2, -1.0 / 12, 1.0 / 180, -1.0 / 6720, 1.0 / 453600);
    m.dc = series(a2, -1.0 / 60, 1.0 / 1260, -1.0 / 60480, 1.0 / 4989600);
    return m;
  }
  const Scalar a = std::sqrt(a2), sine = std::sin(a), cosine = std::cos(a);
  m.b = (Scalar(1) - cosine) / a2;
  m.c = (a - sine) / (a2 * a);
  m.db = (a * sine - Scalar(2) * (Scalar(1) - cosine)) / (a2 * a2);
  m.dc = (Scalar(3) * sine - a * (Scalar(2) + cosine)) / (a2 * a2 * a);
  return m;
}

TurnIntegral turn_integral_of_ramp(const Vec3& phi) {
  TurnIntegral m;
  m.phi = phi;
  const Scalar a2 = phi.squaredNorm();
  if (a2 < kSmall2) {
    m.b = series(a2, 2.0 / 3, -1.0 / 15, 1.0 / 420, -1.0 / 22680);
    m.c = series(a2, 1.0 / 4, -1.0 / 72, 1.0 / 2880, -1.0 / 201600);
    m.db = series(a2, -2.0 / 15, 1.0 / 105, -1.0 / 3780, 1.0 / 249480);
    m.dc = series(a2, -1.0 / 36, 1.0 / 720, -1.0 / 33600, 1.0 / 2721600);
    return m;
  }
  const Scalar a = std::sqrt(a2), sine = std::sin(a), cosine = std::cos(a);
  const Scalar ramp = a * sine + cosine - Scalar(1);
  m.b = Scalar(2) * (sine - a * cosine) / (a2 * a);
  m.c = Scalar(1) / a2 - Scalar(2) * ramp / (a2 * a2);
  m.db = (Scalar(2) * (a2 - Scalar(3)) * sine + Scalar(6) * a * cosine) / (a2 * a2 * a);
  m.dc = (Scalar(8) * ramp - Scalar(2) * a2 * (Scalar(1) + cosine)) / (a2 * a2 * a2);
  return m;
}

}  // namespace pf
