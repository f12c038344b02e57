#pragma once

#include <cmath>

#include "algebra.h"

/// Directions as two angles, of plane bases and of inverse-depth rays alike. There is a pole at +-y.
namespace pfsim::gee {

/// c(theta, phi) = [cos(phi) sin(theta), -sin(phi), cos(phi) cos(theta)]; J 3x2.   src Gee 2007 (5)
inline Vec3 direction(double theta, double phi, Mat<3, 2>* J = nullptr) {
  const double st = std::sin(theta), ct = std::cos(theta), sp = std::sin(phi), cp = std::cos(phi);
  if (J) *J << cp * ct, -sp * st, 0, -cp, -cp * st, -sp * ct;
  return {cp * st, -sp, cp * ct};
}

/// The angles (theta, phi) of g, which need not have unit length, g not along y; J 2x3.   inverse of Gee 2007 (5)
inline Vec2 angles_of(const Vec3& g, Mat<2, 3>* J = nullptr) {
  const double flat2 = g.x() * g.x() + g.z() * g.z(), flat = std::sqrt(flat2), all2 = g.squaredNorm();
  if (J)
    *J << g.z() / flat2, 0, -g.x() / flat2, g.y() * g.x() / (flat * all2), -flat / all2, g.y() * g.z() / (flat * all2);
  return {std::atan2(g.x(), g.z()), std::atan2(-g.y(), flat)};
}

}  // namespace pfsim::gee
