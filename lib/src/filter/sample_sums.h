#pragma once

#include "base/eigen.h"
#include "geometry/so3.h"

/// What a Preintegral leaves where it is kept for long: the samples between two times, in the unit's axes at the first of them, integrated
/// without accelerometer bias.

namespace pf {

struct SampleSums {
  Scalar dt = 0;
  Vec3 gyro_bias = Vec3::Zero();  ///< that they were integrated with
  Quat dq_B = Quat::Identity();
  Vec3 v = Vec3::Zero(), p = Vec3::Zero();
  Eigen::Matrix<float, 9, 6> by_bias = Eigen::Matrix<float, 9, 6>::Zero();  ///< of (phi, v, p), as Preintegral::by_bias

  /// Those of a time before become part of it: with the biases of `before`,
  ///
  ///   R <- R_0 R,   v <- v_0 + R_0 v,   p <- p_0 + v_0 dt + R_0 p
  void begin_with(const SampleSums& before);
};

}  // namespace pf
