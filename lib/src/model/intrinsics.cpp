#include "model/intrinsics.h"

namespace pf {

void Intrinsics::move(const Error& e) {
  for (int i = 0; i < 3; ++i) {
    D_w(i, i) += e(i);
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    D_w(j, k) += e(3 + i);
    D_w(k, j) += e(3 + i);
    for (int c = 0; c < 3; ++c) D_a(i, c) += e(kGyroRows + 3 * i + c);
  }
}

Eigen::Matrix<Scalar, 3, Intrinsics::kGyroRows> Intrinsics::gyro_by_errors(const Vec3& u) {
  Eigen::Matrix<Scalar, 3, kGyroRows> J = Eigen::Matrix<Scalar, 3, kGyroRows>::Zero();
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    J(i, i) = u(i);
    J(j, 3 + i) = u(k);
    J(k, 3 + i) = u(j);
  }
  return J;
}

Eigen::Matrix<Scalar, 3, Intrinsics::kAccelRows> Intrinsics::accel_by_errors(const Vec3& u) {
  Eigen::Matrix<Scalar, 3, kAccelRows> J = Eigen::Matrix<Scalar, 3, kAccelRows>::Zero();
  for (int i = 0; i < 3; ++i)
    for (int c = 0; c < 3; ++c) J(i, 3 * i + c) = u(c);
  return J;
}

Eigen::Matrix<Scalar, 6, Intrinsics::kRows> Intrinsics::by_errors(const Vec3& gyro, const Vec3& accel) {
  Eigen::Matrix<Scalar, 6, kRows> J = Eigen::Matrix<Scalar, 6, kRows>::Zero();
  J.topLeftCorner<3, kGyroRows>() = gyro_by_errors(gyro);
  J.bottomRightCorner<3, kAccelRows>() = accel_by_errors(accel);
  return J;
}

}  // namespace pf
