#pragma once

#include "base/eigen.h"

/// Smooths rotations of a camera: images measure each of them, and a gyroscope the rotation between two (lib/docs/theory/inertial.md).

namespace pf {

struct RotationLink {
  Quat q_WC = Quat::Identity();  ///< by its picture: R_true = Exp(n) R; then the smoothed one
  Scalar variance = 1;           ///< of each axis of n [rad^2]; then that of the smoothed one
  Quat dq = Quat::Identity();    ///< by the gyro: q_WC of the link before times dq is this one's
  Scalar step_variance = 1;      ///< of each axis of its error [rad^2]
  Mat3 by_bias =
      Mat3::Zero();  ///< rotation in the axes at the end of dq by the gyro's bias: dq_true = dq Exp(by_bias b)
  // Between the two passes.
  Quat chain = Quat::Identity();
  Mat3 C = Mat3::Zero(), X = Mat3::Zero();
  Vec3 m = Vec3::Zero(), x = Vec3::Zero();
  Scalar w = 1, d = 1;
};

/// Least squares over all links and the gyro's bias b. With the chain c_0 = q_0, c_k = c_(k-1) dq_k, its rotation by the bias
/// C_k = C_(k-1) + R(c_k) by_bias_k, m_k = Log(q_k c_k^-1), w_k = 1 / variance_k and q_k = Exp(e_k + C_k b) c_k,
///
///   sum_k w_k |e_k + C_k b - m_k|^2 + sum_k |e_k - e_(k-1)|^2 / step_variance_k + |b|^2 / bias_variance  ->  min
///
/// For a b, e = H (m - C b) with H from a tridiagonal system, the same for each axis: eliminated forwards, solved backwards, and so is the
/// diagonal of its inverse. Then
///
///   (sum w C^T (C - H C) + 1 / bias_variance) b = sum w C^T (m - H m)
///
/// bias_variance: of each axis of the bias, beside the one that dq was integrated with [rad^2/s^2]. Returns b.
Vec3 smooth_rotations(RotationLink* link, int count, Scalar bias_variance);

}  // namespace pf
