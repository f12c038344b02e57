#pragma once

#include "angles.h"
#include "camera.h"

/// Points of six numbers: where the camera was (3), the ray's angles theta, phi, and the inverse depth rho [1/m].
namespace pfsim::gee {

/// m = a + c(theta, phi) / rho, rho > 0; J 3x6.   src Montiel et al., Unified inverse depth parametrization
inline Vec3 inverse_depth_point(const Vec6& f, Mat<3, 6>* J = nullptr) {
  Mat<3, 2> J_c;
  const Vec3 c = direction(f(3), f(4), &J_c);
  const double depth = 1 / f(5);
  if (J) *J << Mat3::Identity(), J_c * depth, -c * depth * depth;
  return f.head<3>() + c * depth;
}

struct BirthJacobians {
  Mat<6, 7> J_f_v;  ///< with respect to v = (q, t)
  Mat<6, 3> J_f_n;  ///< with respect to the pixel and the inverse depth
};

/// s(v, z_o) of Gee 2007 (3) for a point seen at z: a = t, angles of R(q) Pi^-1(z), and the prior of inverse depth.
inline Vec6 begin_inverse_depth(const Camera& camera, const Vec7& v, const Vec2& z, double rho, BirthJacobians* J) {
  const Vec4 q = v.head<4>();
  Vec3 ray_C;
  ray_C << (z - camera.centre()) / camera.focal, 1;
  Mat<3, 4> J_g_q;
  Mat<2, 3> J_angles_g;
  const Vec3 g = rotate(q, ray_C, &J_g_q);
  Vec6 f;
  f << v.tail<3>(), angles_of(g, &J_angles_g), rho;
  J->J_f_v.setZero();
  J->J_f_v.block<3, 3>(0, 4).setIdentity();
  J->J_f_v.block<2, 4>(3, 0) = J_angles_g * J_g_q;
  J->J_f_n.setZero();
  J->J_f_n.block<2, 2>(3, 0) = J_angles_g * rotation_of(q).leftCols<2>() / camera.focal;
  J->J_f_n(5, 2) = 1;
  return f;
}

/// How far from linear the depth is when seen from t: 4 sigma_d |cos(alpha)| / d, alpha between the two rays.
/// src    Civera et al., Inverse depth to depth conversion for monocular SLAM
inline double linearity_index(const Vec6& f, double sigma_rho, const Vec3& t) {
  const Vec3 c = direction(f(3), f(4)), way = inverse_depth_point(f) - t;
  const double d = way.norm();
  return 4 * sigma_rho / (f(5) * f(5)) * std::abs(c.dot(way) / d) / d;
}

}  // namespace pfsim::gee
