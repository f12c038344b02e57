#pragma once

#include "base/eigen.h"

namespace pf {

/// Errors of scale and of axes that are not at right angles, of an inertial unit with axes B (IMU intrinsics), beside its biases.
///
///   w_B = D_w (gyro - b_g),   f_B = D_a (accel - b_a)
///
/// D_w is symmetric: a rotation of the gyroscope's axes belongs to the mounting, which defines B. D_a is any matrix, since the
/// accelerometer may be rotated against the gyroscope. Errors, additive:
///
///   D_w: e_1 .. e_6 of (xx, yy, zz, yz, xz, xy), those off the diagonal in both places;   D_a: e_7 .. e_15, row-major
struct Intrinsics {
  static constexpr int kGyroRows = 6, kAccelRows = 9, kRows = kGyroRows + kAccelRows;
  using Error = Eigen::Matrix<Scalar, kRows, 1>;

  Mat3 D_w = Mat3::Identity();
  Mat3 D_a = Mat3::Identity();
  bool open = false;  ///< they are estimated

  void move(const Error& e);
  /// D u by the errors.
  static Eigen::Matrix<Scalar, 3, kGyroRows> gyro_by_errors(const Vec3& u);
  static Eigen::Matrix<Scalar, 3, kAccelRows> accel_by_errors(const Vec3& u);
  /// Both side by side: w_B by gyro - b_g in the first three rows, f_B by accel - b_a in the others.
  static Eigen::Matrix<Scalar, 6, kRows> by_errors(const Vec3& gyro, const Vec3& accel);
};

}  // namespace pf
