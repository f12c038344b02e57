#pragma once

#include "base/eigen.h"
#include "vision/simd.h"

/// Warps of a patch on a plane: ways in which its reference rays may move. They differ in their 2xk Jacobian and in nothing else.
///
/// X = (X, Y, 1) is a ray of the reference image about the patch's middle, in half sides of the patch. A warp's step e moves it to
/// increment(e) X, up to scale, and to first order by jacobian(X, Y) e.

namespace pf {

/// None: what remains are gain and bias.
struct LightWarp {
  static constexpr int kSize = 0;
  PF_ALWAYS_INLINE void rows(const F32x4&, const F32x4&, const F32x4&, const F32x4&, F32x4*) const {}
};

/// A translation in the image.
struct ShiftWarp {
  static constexpr int kSize = 2;
  using Step = Eigen::Matrix<Scalar, kSize, 1>;
  using Jacobian = Eigen::Matrix<Scalar, 2, kSize>;

  void begin(const Mat3&) {}
  Jacobian jacobian(Scalar, Scalar) const { return Jacobian::Identity(); }
  Mat3 increment(const Step& e) const {
    Mat3 A = Mat3::Identity();
    A(0, 2) = e(0);
    A(1, 2) = e(1);
    return A;
  }
  /// J = g^T jacobian, for four rays.
  PF_ALWAYS_INLINE void rows(const F32x4&, const F32x4&, const F32x4& gx, const F32x4& gy, F32x4* J) const {
    J[0] = gx;
    J[1] = gy;
  }
};

/// The slopes of a plane through a ray that stays where it is, seen from a place that is known: H = R + t m^T, m . x0 fixed.
///
///   H + t (a1 e1 + a2 e2)^T = H (I + q (a1 e1 + a2 e2)^T),   q = H^-1 t,   e1, e2 orthogonal to the ray x0
///
/// All in the patch's own coordinates, where x0 = (0, 0, 1): e1 = (1, 0, 0), e2 = (0, 1, 0), t as H maps to.
struct SlopesWarp {
  static constexpr int kSize = 2;
  using Step = Eigen::Matrix<Scalar, kSize, 1>;
  using Jacobian = Eigen::Matrix<Scalar, 2, kSize>;

  Vec3 t = Vec3::Zero();
  Vec3 q = Vec3::Zero();

  void begin(const Mat3& H) { q = H.inverse() * t; }
  Jacobian jacobian(Scalar X, Scalar Y) const {
    const Vec2 along(q.x() - X * q.z(), q.y() - Y * q.z());
    Jacobian J;
    J.col(0) = along * X;
    J.col(1) = along * Y;
    return J;
  }
  Mat3 increment(const Step& e) const { return Mat3::Identity() + q * Vec3(e(0), e(1), 0).transpose(); }
  PF_ALWAYS_INLINE void rows(const F32x4& X, const F32x4& Y, const F32x4& gx, const F32x4& gy, F32x4* J) const {
    const float x = static_cast<float>(q.x()), y = static_cast<float>(q.y()), z = static_cast<float>(q.z());
    const F32x4 along = gx * (x - X * z) + gy * (y - Y * z);
    J[0] = along * X;
    J[1] = along * Y;
  }
};

/// Any homography: H exp(A(e)), A with the entries e0 .. e7 row by row and a zero at the end.
struct HomographyWarp {
  static constexpr int kSize = 8;
  using Step = Eigen::Matrix<Scalar, kSize, 1>;
  using Jacobian = Eigen::Matrix<Scalar, 2, kSize>;

  void begin(const Mat3&) {}
  Jacobian jacobian(Scalar X, Scalar Y) const {
    Jacobian J;
    J << X, Y, 1, 0, 0, 0, -X * X, -X * Y, 0, 0, 0, X, Y, 1, -X * Y, -Y * Y;
    return J;
  }
  /// To second order, which is what makes the step with the mean of both gradients one of second order.
  Mat3 increment(const Step& e) const {
    Mat3 A;
    A << e(0), e(1), e(2), e(3), e(4), e(5), e(6), e(7), 0;
    return Mat3::Identity() + A + Mat3(A * A) / 2;
  }
  PF_ALWAYS_INLINE void rows(const F32x4& X, const F32x4& Y, const F32x4& gx, const F32x4& gy, F32x4* J) const {
    const F32x4 along = -(gx * X + gy * Y);
    J[0] = gx * X;
    J[1] = gx * Y;
    J[2] = gx;
    J[3] = gy * X;
    J[4] = gy * Y;
    J[5] = gy;
    J[6] = along * X;
    J[7] = along * Y;
  }
};

}  // namespace pf
