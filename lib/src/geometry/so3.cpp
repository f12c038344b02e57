#include "geometry/so3.h"

#include <cmath>

namespace pf {

Mat3 hat(const Vec3& a) {
  Mat3 m;
  m << Scalar(0), -a.z(), a.y(), a.z(), Scalar(0), -a.x(), -a.y(), a.x(), Scalar(0);
  return m;
}

Quat exp_so3(const Vec3& theta) {
  const Scalar a2 = theta.squaredNorm();
  Scalar w, k;  // cos(a/2), sin(a/2)/a
  if (a2 < Scalar(1e-6)) {
    w = Scalar(1) - a2 / Scalar(8);
    k = Scalar(0.5) - a2 / Scalar(48);
  } else {
    const Scalar a = std::sqrt(a2);
    w = std::cos(a / Scalar(2));
    k = std::sin(a / Scalar(2)) / a;
  }
  Quat q(w, k * theta.x(), k * theta.y(), k * theta.z());
  q.normalize();
  return q;
}

Vec3 log_so3(const Quat& q) {
  const Scalar sign = q.w() < Scalar(0) ? Scalar(-1) : Scalar(1);
  const Vec3 v = sign * q.vec();
  const Scalar w = sign * q.w();
  const Scalar n = v.norm();
  if (n < Scalar(1e-6)) return v * (Scalar(2) / w);
  return v * (Scalar(2) * std::atan2(n, w) / n);
}

Quat turn_z_to(const Vec3& b) {
  const Scalar w = Scalar(1) + b.z();
  Quat q = w > Scalar(1e-6) ? Quat(w, -b.y(), b.x(), Scalar(0)) : Quat(Scalar(0), Scalar(1), Scalar(0), Scalar(0));
  q.normalize();
  return q;
}

Mat3 left_jacobian_so3(const Vec3& phi) {
  const Scalar a2 = phi.squaredNorm();
  Scalar b, c;  // (1 - cos a)/a^2, (a - sin a)/a^3
  if (a2 < Scalar(1e-4)) {
    b = Scalar(0.5) - a2 / Scalar(24);
    c = Scalar(1) / Scalar(6) - a2 / Scalar(120);
  } else {
    const Scalar a = std::sqrt(a2);
    b = (Scalar(1) - std::cos(a)) / a2;
    c = (a - std::sin(a)) / (a2 * a);
  }
  const Mat3 h = hat(phi);
  return Mat3::Identity() + b * h + c * h.lazyProduct(h);
}

}  // namespace pf
