#pragma once

#include "base/eigen.h"

namespace pf {

/// Moves a whole world: p -> s R p + t. Lengths become s times as large, and directions are rotated by R.
struct Similarity {
  Quat q = Quat::Identity();
  Vec3 t = Vec3::Zero();
  Scalar s = 1;

  Vec3 of(const Vec3& p) const { return s * (q * p) + t; }

  /// Multiplies lengths about a place that stays.
  static Similarity about(const Vec3& c, Scalar s) { return {Quat::Identity(), c - s * c, s}; }

  /// Covariance of (theta, p) of what is moved: theta -> R theta, p -> s R p.
  Mat6 of_pose_covariance(const Mat6& P) const {
    Mat6 J = Mat6::Zero();
    J.topLeftCorner<3, 3>() = q.toRotationMatrix();
    J.bottomRightCorner<3, 3>() = s * J.topLeftCorner<3, 3>();
    return J.lazyProduct(P).lazyProduct(J.transpose());
  }
};

}  // namespace pf
