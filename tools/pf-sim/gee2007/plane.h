#pragma once

#include "angles.h"

/// Planes of seven numbers: p_o (3), theta_1, phi_1, theta_2, phi_2, and the points in them of two.
///
/// The two basis vectors begin at right angles and nothing keeps them so.   src Gee 2007, section 3.2
namespace pfsim::gee {

/// n = c_1 x c_2, given unit length.
inline Vec3 plane_normal(const Vec7& s) { return direction(s(3), s(4)).cross(direction(s(5), s(6))).normalized(); }

struct FoldJacobians {
  Mat<2, 7> J_u_s;  ///< with respect to the plane
  Mat<2, 3> J_u_m;  ///< with respect to the point in W
};

/// u = [(m - p_o) . c_1, (m - p_o) . c_2].   src Gee 2007 (6)
inline Vec2 fold_point(const Vec7& s, const Vec3& m, FoldJacobians* J = nullptr) {
  Mat<3, 2> J_1, J_2;
  const Vec3 c1 = direction(s(3), s(4), &J_1), c2 = direction(s(5), s(6), &J_2), way = m - s.head<3>();
  if (J) {
    J->J_u_m << c1.transpose(), c2.transpose();
    J->J_u_s.setZero();
    J->J_u_s.leftCols<3>() = -J->J_u_m;
    J->J_u_s.block<1, 2>(0, 3) = way.transpose() * J_1;
    J->J_u_s.block<1, 2>(1, 5) = way.transpose() * J_2;
  }
  return {way.dot(c1), way.dot(c2)};
}

struct UnfoldJacobians {
  Mat<3, 7> J_m_s;  ///< with respect to the plane
  Mat<3, 2> J_m_u;  ///< with respect to the point in it
};

/// m = [c_1 c_2] u + p_o.   src Gee 2007 (9)
inline Vec3 unfold_point(const Vec7& s, const Vec2& u, UnfoldJacobians* J = nullptr) {
  Mat<3, 2> J_1, J_2;
  const Vec3 c1 = direction(s(3), s(4), &J_1), c2 = direction(s(5), s(6), &J_2);
  if (J) {
    J->J_m_u << c1, c2;
    J->J_m_s << Mat3::Identity(), u(0) * J_1, u(1) * J_2;
  }
  return s.head<3>() + u(0) * c1 + u(1) * c2;
}

}  // namespace pfsim::gee
