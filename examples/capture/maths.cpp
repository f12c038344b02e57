#include "maths.h"

#include <algorithm>
#include <cmath>

namespace pf::capture {

Ellipse ellipse_of(double c00, double c01, double c11) {
  const double mean = 0.5 * (c00 + c11);
  const double half = 0.5 * (c00 - c11);
  const double radius = std::sqrt(half * half + c01 * c01);
  return {std::sqrt(std::max(0.0, mean + radius)), std::sqrt(std::max(0.0, mean - radius)),
          0.5 * std::atan2(2.0 * c01, c00 - c11)};
}

double largest_sigma(const double c[9]) {
  // Closed form: the eigenvalues are m + 2 p cos(phi + 2 k pi / 3), and the largest has k = 0.
  const double m = (c[0] + c[4] + c[8]) / 3.0;
  const double off = c[1] * c[1] + c[2] * c[2] + c[5] * c[5];
  const double a = c[0] - m;
  const double b = c[4] - m;
  const double d = c[8] - m;
  const double p = std::sqrt((a * a + b * b + d * d + 2.0 * off) / 6.0);
  if (!(p > 0.0)) {
    return std::sqrt(std::max(0.0, m));
  }
  const double determinant =
      a * (b * d - c[5] * c[5]) - c[1] * (c[1] * d - c[5] * c[2]) + c[2] * (c[1] * c[5] - b * c[2]);
  const double r = std::clamp(determinant / (2.0 * p * p * p), -1.0, 1.0);
  return std::sqrt(std::max(0.0, m + 2.0 * p * std::cos(std::acos(r) / 3.0)));
}

Vec3 rotation_column(const double q[4], int column) {
  const double w = q[0];
  const double x = q[1];
  const double y = q[2];
  const double z = q[3];
  switch (column) {
    case 0:
      return {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)};
    case 1:
      return {2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)};
    default:
      return {2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)};
  }
}

Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace pf::capture
