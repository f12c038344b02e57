#pragma once

#include <cmath>
#include <limits>

#include "geometry/camera.h"

namespace pf {

/// Parts of the camera models, shared by camera.cpp and camera_domain.cpp.

/// Rays more than this from the axis (tan 89.9 degrees) are outside of every flat model.
constexpr Scalar kMaxTangent = Scalar(572.957);
/// Equidistant: no ray straight backwards.
constexpr Scalar kMaxTheta = Scalar(3.13);
/// Slope below which a model counts as folding back.
constexpr Scalar kMinSlope = Scalar(0.01);

/// How many distortion coefficients of a model can be uncertain; a pinhole may get k1.
inline int num_uncertain_distortion(CameraModel model) {
  switch (model) {
    case CameraModel::kRadtan:
      return 5;
    case CameraModel::kEquidistant:
      return 4;
    default:
      return 1;
  }
}

/// Radial-tangential distortion of m and its Jacobian, which is symmetric.
inline Vec2 distort_radtan(const Scalar k[8], const Vec2& m, Mat2* J) {
  const Scalar x = m.x(), y = m.y(), r2 = x * x + y * y;
  const Scalar radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const Scalar slope = k[0] + r2 * (2 * k[1] + r2 * 3 * k[4]);  // d radial / d r²
  if (J != nullptr) {
    const Scalar off = 2 * (x * y * slope + k[2] * x + k[3] * y);
    *J << radial + 2 * x * x * slope + 2 * k[2] * y + 6 * k[3] * x, off,  //
        off, radial + 2 * y * y * slope + 6 * k[2] * y + 2 * k[3] * x;
  }
  return Vec2(x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x),
              y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y);
}

/// Smallest slope of the radial-tangential model on the circle of radius r. In radial and tangential directions
///
///   J = [a + 6 r s    2 r t  ]     a = 1 + 3 k1 r² + 5 k2 r⁴ + 7 k3 r⁶     s² + t² = p1² + p2²
///       [  2 r t    b + 2 r s]     b = 1 +   k1 r² +   k2 r⁴ +   k3 r⁶
///
/// J is symmetric, so that a disc on which it is positive definite is mapped one to one. The bound takes s and t at their
/// worst, which costs a little of the domain and nothing where p is small.
inline Scalar radtan_slope(const Scalar k[8], Scalar r) {
  const Scalar r2 = r * r, p = std::hypot(k[2], k[3]);
  const Scalar a = 1 + r2 * (3 * k[0] + r2 * (5 * k[1] + r2 * 7 * k[4]));
  const Scalar b = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const Scalar radial = a - 8 * r * p, tangential = b - 4 * r * p;
  return radial < tangential ? radial : tangential;
}

/// Kannala-Brandt polynomial θd(θ) and its slope.
inline Scalar distort_theta(const Scalar k[8], Scalar theta, Scalar* slope) {
  const Scalar t2 = theta * theta;
  *slope = 1 + t2 * (3 * k[0] + t2 * (5 * k[1] + t2 * (7 * k[2] + t2 * 9 * k[3])));
  return theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
}

/// Depths of what flat models see.
constexpr Scalar kMinDepth = Scalar(1e-9);
constexpr Scalar kMaxDepth = std::numeric_limits<Scalar>::max();

/// project() of a pinhole for loops that cannot afford a call. Its Jacobian is [a 0 b; 0 c d], slope = (a, b, c, d).
inline bool project_pinhole(const Camera& c, const Vec3& p_C, Vec2* pixel, Vec4* slope) {
  if (!(p_C.z() > kMinDepth && p_C.z() <= kMaxDepth)) return false;
  const Scalar w = 1 / p_C.z();
  const Vec2 m(p_C.x() * w, p_C.y() * w);
  if (!(m.squaredNorm() <= c.max_r2)) return false;
  const Scalar x = c.fx * w, y = c.fy * w;
  *pixel = Vec2(c.fx * m.x() + c.cx, c.fy * m.y() + c.cy);
  *slope = Vec4(x, -(x * m.x()), y, -(y * m.y()));
  return true;
}

}  // namespace pf
