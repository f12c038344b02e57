#pragma once

#include "base/eigen.h"

/// Rotations of a camera of which pictures tell each by itself, and a gyro how it rotated from one to the next (lib/docs/inertial.md).

namespace pf {

struct RotationLink {
  Quat q_WC = Quat::Identity();  ///< by its picture: R_true = Exp(n) R; then the smoothed one
  Scalar variance = 1;           ///< of each axis of n [rad^2]; then that of the smoothed one
  Quat dq = Quat::Identity();    ///< by the gyro: q_WC of the link before times dq is this one's
  Scalar step_variance = 1;      ///< of each axis of its error [rad^2]
  // Between the two passes.
  Quat chain = Quat::Identity();
  Vec3 x = Vec3::Zero();
  Scalar d = 1;
};

/// Least squares over all links. With the chain c_0 = q_0, c_k = c_(k-1) dq_k, and q_k = Exp(e_k) c_k,
///
///   sum_k |e_k - Log(q_k c_k^-1)|^2 / variance_k + sum_k |e_k - e_(k-1)|^2 / step_variance_k  ->  min
///
/// a tridiagonal system, the same for each axis: eliminated forwards, solved backwards, and so is the diagonal of its inverse.
void smooth_rotations(RotationLink* link, int count);

}  // namespace pf
