#pragma once

#include <array>
#include <cmath>

namespace pf::sim {

/// Three doubles with the arithmetic that the simulator needs.
struct Vec3 {
  double x = 0, y = 0, z = 0;

  Vec3 operator+(const Vec3& b) const { return {x + b.x, y + b.y, z + b.z}; }
  Vec3 operator-(const Vec3& b) const { return {x - b.x, y - b.y, z - b.z}; }
  Vec3 operator-() const { return {-x, -y, -z}; }
  Vec3 operator*(double s) const { return {x * s, y * s, z * s}; }
  Vec3& operator+=(const Vec3& b) { return *this = *this + b; }
  double dot(const Vec3& b) const { return x * b.x + y * b.y + z * b.z; }
  Vec3 cross(const Vec3& b) const { return {y * b.z - z * b.y, z * b.x - x * b.z, x * b.y - y * b.x}; }
  double norm() const { return std::sqrt(dot(*this)); }
  Vec3 unit() const { return *this * (1.0 / norm()); }
};

/// 3x3, row-major.
struct Mat3 {
  std::array<double, 9> m{1, 0, 0, 0, 1, 0, 0, 0, 1};

  double operator()(int r, int c) const { return m[static_cast<std::size_t>(3 * r + c)]; }
  double& operator()(int r, int c) { return m[static_cast<std::size_t>(3 * r + c)]; }
  Vec3 operator*(const Vec3& v) const {
    return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[3] * v.x + m[4] * v.y + m[5] * v.z,
            m[6] * v.x + m[7] * v.y + m[8] * v.z};
  }
  Mat3 operator*(const Mat3& b) const {
    Mat3 out;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c)
        out(r, c) = (*this)(r, 0) * b(0, c) + (*this)(r, 1) * b(1, c) + (*this)(r, 2) * b(2, c);
    return out;
  }
  Mat3 transposed() const { return {{m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]}}; }
  static Mat3 columns(const Vec3& a, const Vec3& b, const Vec3& c) {
    return {{a.x, b.x, c.x, a.y, b.y, c.y, a.z, b.z, c.z}};
  }
};

/// Camera in the world: p_W = R_WC p_C + p_WC.
struct Pose {
  Mat3 R_WC;
  Vec3 p_WC;
};

/// Rotation by a rotation vector: Exp(w) = I + sin a [k]x + (1 - cos a) [k]x^2, a = |w|.
inline Mat3 rotation_exp(const Vec3& w) {
  const double a = w.norm();
  const double s = a < 1e-6 ? 1 - a * a / 6 : std::sin(a) / a;
  const double c = a < 1e-6 ? 0.5 - a * a / 24 : (1 - std::cos(a)) / (a * a);
  Mat3 R;
  R(0, 0) = 1 - c * (w.y * w.y + w.z * w.z);
  R(1, 1) = 1 - c * (w.x * w.x + w.z * w.z);
  R(2, 2) = 1 - c * (w.x * w.x + w.y * w.y);
  R(0, 1) = c * w.x * w.y - s * w.z;
  R(1, 0) = c * w.x * w.y + s * w.z;
  R(0, 2) = c * w.x * w.z + s * w.y;
  R(2, 0) = c * w.x * w.z - s * w.y;
  R(1, 2) = c * w.y * w.z - s * w.x;
  R(2, 1) = c * w.y * w.z + s * w.x;
  return R;
}

/// Quaternion (w, x, y, z) of a rotation, w >= 0.
inline std::array<double, 4> quaternion_of(const Mat3& R) {
  // Of the four squares, the largest is at least 1/4, so dividing by it is safe.
  const double t[4] = {1 + R(0, 0) + R(1, 1) + R(2, 2), 1 + R(0, 0) - R(1, 1) - R(2, 2),
                       1 - R(0, 0) + R(1, 1) - R(2, 2), 1 - R(0, 0) - R(1, 1) + R(2, 2)};
  int k = 0;
  for (int i = 1; i < 4; ++i)
    if (t[i] > t[k]) k = i;
  const double r = 0.5 * std::sqrt(t[k]), f = 0.25 / r;
  std::array<double, 4> q{};
  if (k == 0) q = {r, (R(2, 1) - R(1, 2)) * f, (R(0, 2) - R(2, 0)) * f, (R(1, 0) - R(0, 1)) * f};
  if (k == 1) q = {(R(2, 1) - R(1, 2)) * f, r, (R(0, 1) + R(1, 0)) * f, (R(0, 2) + R(2, 0)) * f};
  if (k == 2) q = {(R(0, 2) - R(2, 0)) * f, (R(0, 1) + R(1, 0)) * f, r, (R(1, 2) + R(2, 1)) * f};
  if (k == 3) q = {(R(1, 0) - R(0, 1)) * f, (R(0, 2) + R(2, 0)) * f, (R(1, 2) + R(2, 1)) * f, r};
  if (q[0] < 0)
    for (double& v : q) v = -v;
  return q;
}

inline Mat3 rotation_of(const double q[4]) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  return {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z),
           1 - 2 * (x * x + z * z), 2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x),
           1 - 2 * (x * x + y * y)}};
}

/// Rotation vector of R, |result| <= pi.
inline Vec3 rotation_log(const Mat3& R) {
  const auto q = quaternion_of(R);
  const Vec3 v{q[1], q[2], q[3]};
  const double s = v.norm();
  return s < 1e-12 ? v * 2.0 : v * (2.0 * std::atan2(s, q[0]) / s);
}

/// Camera (x right, y down, z forward) that looks along `forward` with its x axis level; `down` is W's down.
inline Mat3 look_along(const Vec3& forward, const Vec3& down) {
  const Vec3 z = forward.unit();
  const Vec3 x = down.cross(z).unit();
  return Mat3::columns(x, z.cross(x), z);
}

}  // namespace pf::sim
