#pragma once

#include "base/eigen.h"

namespace pf {

/// Moves a whole world: p -> s R p + t. Lengths become s times as large, and directions are rotated by R.
struct Similarity {
  Quat q = Quat::Identity();
  Vec3 t = Vec3::Zero();
  Scalar s = 1;

  Vec3 of(const Vec3& p) const { return s * (q * p) + t; }
  /// First the other one, then this one.
  Similarity after(const Similarity& first) const { return {(q * first.q).normalized(), of(first.t), s * first.s}; }

  /// Multiplies lengths about a place that stays.
  static Similarity about(const Vec3& c, Scalar s) { return {Quat::Identity(), c - s * c, s}; }

  /// Takes a camera from one pose to another: p_1 = R p_0 + t, R_1 = R R_0. Exactly the identity where both are the same.
  static Similarity between(const Quat& q_0, const Vec3& p_0, const Quat& q_1, const Vec3& p_1) {
    if (q_0.coeffs() == q_1.coeffs() && p_0 == p_1) return Similarity();
    const Quat q = (q_1 * q_0.conjugate()).normalized();
    return {q, p_1 - q * p_0, Scalar(1)};
  }

  /// Covariance of (theta, p) of what is moved: theta -> R theta, p -> s R p.
  Mat6 of_pose_covariance(const Mat6& P) const {
    Mat6 J = Mat6::Zero();
    J.topLeftCorner<3, 3>() = q.toRotationMatrix();
    J.bottomRightCorner<3, 3>() = s * J.topLeftCorner<3, 3>();
    return J.lazyProduct(P).lazyProduct(J.transpose());
  }
};

}  // namespace pf
