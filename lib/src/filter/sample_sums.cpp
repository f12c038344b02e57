#include "filter/sample_sums.h"

namespace pf {

void SampleSums::begin_with(const SampleSums& before) {
  const Eigen::Matrix<Scalar, 9, 6> D = by_bias.cast<Scalar>(), D_before = before.by_bias.cast<Scalar>();
  const Vec3 more = before.gyro_bias - gyro_bias;
  const Mat3 R = before.dq_B.toRotationMatrix();
  const Vec3 Rv = R * (v + D.block<3, 3>(3, 0) * more), Rp = R * (p + D.block<3, 3>(6, 0) * more);
  Eigen::Matrix<Scalar, 9, 6> sum = D_before;
  sum.middleRows<3>(6) += dt * D_before.middleRows<3>(3) - hat(Rp) * D_before.topRows<3>();
  sum.middleRows<3>(3) -= hat(Rv) * D_before.topRows<3>();
  for (int row = 0; row < 9; row += 3) sum.middleRows<3>(row) += R * D.middleRows<3>(row);
  dq_B = before.dq_B * exp_so3(Vec3(D.topLeftCorner<3, 3>() * more)) * dq_B;
  p = before.p + dt * before.v + Rp;
  v = before.v + Rv;
  dt += before.dt;
  gyro_bias = before.gyro_bias;
  by_bias = sum.cast<float>();
}

}  // namespace pf
