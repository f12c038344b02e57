#pragma once

#include <cmath>

#include "algebra.h"

/// Quaternions q = (w, x, y, z) of the camera in the world, R(q) = R_WC, and their derivatives.
namespace pfsim::gee {

inline Mat3 rotation_of(const Vec4& q) {
  return Eigen::Quaterniond(q(0), q(1), q(2), q(3)).normalized().toRotationMatrix();
}

inline Vec4 quaternion_of(const Mat3& R) {
  const Eigen::Quaterniond q(R);
  return {q.w(), q.x(), q.y(), q.z()};
}

/// R(q) v = (w^2 - u.u) v + 2 u (u.v) + 2 w u x v with q = (w, u), |q| = 1.
///
/// J_q 3x4, the derivative of the right side as it stands; along q itself it is 2 R v, where the covariance has nothing.
inline Vec3 rotate(const Vec4& q, const Vec3& v, Mat<3, 4>* J_q = nullptr) {
  const double w = q(0);
  const Vec3 u = q.tail<3>();
  if (J_q) {
    J_q->col(0) = 2 * (w * v + u.cross(v));
    J_q->rightCols<3>() =
        2 * (u.dot(v) * Mat3::Identity() + u * v.transpose() - v * u.transpose() - w * cross_matrix(v));
  }
  return (w * w - u.squaredNorm()) * v + 2 * u.dot(v) * u + 2 * w * u.cross(v);
}

/// R(q)^T v: rotate with the conjugate. J_q 3x4.
inline Vec3 rotate_back(const Vec4& q, const Vec3& v, Mat<3, 4>* J_q = nullptr) {
  const Vec4 conjugate(q(0), -q(1), -q(2), -q(3));
  const Vec3 out = rotate(conjugate, v, J_q);
  if (J_q) J_q->rightCols<3>() *= -1;
  return out;
}

/// a (x) b, which turns by b first: R(a (x) b) = R(a) R(b).
inline Vec4 product(const Vec4& a, const Vec4& b) {
  Vec4 q;
  q(0) = a(0) * b(0) - a.tail<3>().dot(b.tail<3>());
  q.tail<3>() = a(0) * b.tail<3>() + b(0) * a.tail<3>() + a.tail<3>().cross(b.tail<3>());
  return q;
}

/// Delta q(w) of Gee 2007 (1): the quaternion of the Euler angles w, about x first, then y, then z.
inline Vec4 increment(const Vec3& w) {
  const Vec4 x(std::cos(w.x() / 2), std::sin(w.x() / 2), 0, 0), y(std::cos(w.y() / 2), 0, std::sin(w.y() / 2), 0),
      z(std::cos(w.z() / 2), 0, 0, std::sin(w.z() / 2));
  return product(z, product(y, x));
}

/// d(Delta q(w) (x) q)/dw at w = 0, 4x3. Also the way from a small world-side rotation to q.
inline Mat<4, 3> increment_jacobian(const Vec4& q) {
  Mat<4, 3> J;
  const Vec3 u = q.tail<3>();
  J.topRows<1>() = -0.5 * u.transpose();
  J.bottomRows<3>() = 0.5 * (q(0) * Mat3::Identity() - cross_matrix(u));
  return J;
}

/// d(q / |q|)/dq, 4x4.
inline Mat4 normalisation_jacobian(const Vec4& q) {
  const double length = q.norm();
  const Vec4 unit = q / length;
  return (Mat4::Identity() - unit * unit.transpose()) / length;
}

/// The small world-side rotation that leads from q to q_true, whichever of its two signs q_true has.
inline Vec3 rotation_error(const Vec4& q, const Vec4& q_true) {
  const Vec4 conjugate(q(0), -q(1), -q(2), -q(3));
  const Vec4 d = product(q_true, conjugate);
  const double sine = d.tail<3>().norm();
  if (sine < 1e-12) return Vec3::Zero();
  double angle = 2 * std::atan2(sine, d(0));
  if (d(0) < 0) angle -= 2 * 3.14159265358979323846;
  return d.tail<3>() * (angle / sine);
}

}  // namespace pfsim::gee
