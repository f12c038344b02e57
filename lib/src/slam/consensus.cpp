#include "slam/consensus.h"

#include <algorithm>
#include <cmath>

namespace pf {

Scalar squared_distance(const Vec2& r, const Mat2& S) {
  const Scalar det = S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0);
  if (!(det > Scalar(0)) || !(S(0, 0) > Scalar(0))) return kNoDistance2;
  return (r.x() * (S(1, 1) * r.x() - S(0, 1) * r.y()) + r.y() * (S(0, 0) * r.y() - S(1, 0) * r.x())) / det;
}

bool is_covariance(const Mat2& S) {
  return std::isfinite(S(0, 0)) && std::isfinite(S(1, 1)) && S(0, 0) > Scalar(0) &&
         S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0) > Scalar(0);
}

Scalar ellipse_area(const Mat2& S, Scalar gate) {
  constexpr Scalar kPi = Scalar(3.14159265);
  const Scalar det = S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0);
  return kPi * gate * std::sqrt(std::max(det, Scalar(0)));
}

}  // namespace pf
