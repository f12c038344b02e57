#include "slam/consensus.h"

#include <algorithm>
#include <cmath>

namespace pf {

bool is_covariance(const Mat2& S) {
  const Scalar det = S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0);
  return S(0, 0) > Scalar(0) && det > Scalar(0) && std::isfinite(det);
}

Scalar ellipse_area(const Mat2& S, Scalar gate) {
  constexpr Scalar kPi = Scalar(3.14159265);
  const Scalar det = S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0);
  return kPi * gate * std::sqrt(std::max(det, Scalar(0)));
}

}  // namespace pf
