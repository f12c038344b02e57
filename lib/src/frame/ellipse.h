#pragma once

#include <algorithm>
#include <cmath>

#include "base/eigen.h"

/// Ellipses of pixels.

namespace pf {

/// Squared distance where S is no covariance.
inline constexpr Scalar kNoDistance2 = Scalar(1e12);

/// r^T S^-1 r of one observation with covariance S [px^2]; huge where S is not positive. In the header, since the innermost loop of
/// find_inliers calls it.
inline Scalar squared_distance(const Vec2& r, const Mat2& S) {
  const Scalar det = S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0);
  if (!(det > Scalar(0)) || !(S(0, 0) > Scalar(0))) return kNoDistance2;
  return (r.x() * (S(1, 1) * r.x() - S(0, 1) * r.y()) + r.y() * (S(0, 0) * r.y() - S(1, 0) * r.x())) / det;
}

/// Whether an innovation covariance S = H P H^T + R is one: positive definite, with a finite determinant. It is not where H P H^T is a
/// difference of numbers so large that rounding exceeds R: a position far from the map's origin with a variance of 1e6 and a point close to
/// the camera, which shares nearly all of it. Such a pixel cannot be measured.
inline bool is_covariance(const Mat2& S) {
  const Scalar det = S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0);
  return S(0, 0) > Scalar(0) && det > Scalar(0) && std::isfinite(det);
}

/// Of the ellipse r^T S^-1 r < gate [px^2].
inline Scalar ellipse_area(const Mat2& S, Scalar gate) {
  constexpr Scalar kPi = Scalar(3.14159265);
  const Scalar det = S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0);
  return kPi * gate * std::sqrt(std::max(det, Scalar(0)));
}

}  // namespace pf
