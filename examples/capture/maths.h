#ifndef PLANEFOLD_CAPTURE_MATHS_H
#define PLANEFOLD_CAPTURE_MATHS_H

#include <array>

namespace pf::capture {

using Vec3 = std::array<double, 3>;

/// Half axes and direction of the ellipse xᵀ C⁻¹ x = 1 of a 2x2 covariance (row-major).
struct Ellipse {
  double a, b;   ///< a >= b >= 0
  double angle;  ///< of a, from the first axis towards the second [rad]
};
Ellipse ellipse_of(double c00, double c01, double c11);

/// sqrt of the largest eigenvalue of a symmetric 3x3 (row-major): the standard deviation along the worst direction.
double largest_sigma(const double covariance[9]);

/// Column 0, 1 or 2 of R(q), q = (w, x, y, z): an axis of the camera in W when q is q_WC.
Vec3 rotation_column(const double q[4], int column);

inline double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3 cross(const Vec3& a, const Vec3& b);

}  // namespace pf::capture

#endif
