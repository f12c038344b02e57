#include "filter/preintegral.h"

#include "geometry/so3.h"

namespace pf {

__attribute__((noinline)) Preintegral::Covariance Preintegral::transformed(const Covariance& J, const Covariance& S) {
  Covariance JS = Covariance::Zero(), out = Covariance::Zero();
  for (int j = 0; j < kRows; ++j)
    for (int k = 0; k < kRows; ++k)
      for (int i = 0; i < kRows; ++i) JS(i, j) += J(i, k) * S(k, j);
  for (int j = 0; j < kRows; ++j)
    for (int k = 0; k < kRows; ++k)
      for (int i = 0; i < kRows; ++i) out(i, j) += JS(i, k) * J(j, k);
  return out;
}

/// S <- F S F^T, and the Jacobian by the biases that were there at the beginning.
void Preintegral::move_errors(const Covariance& F) {
  S_ = transformed(F, S_);
  ByBias moved = F.topRightCorner<9, 6>();
  for (int j = 0; j < 6; ++j)
    for (int k = 0; k < 9; ++k)
      for (int i = 0; i < 9; ++i) moved(i, j) += F(i, k) * D_(k, j);
  D_ = moved;
}

/// What was there goes on as (phi, v, p) do, and the step adds its own.
void Preintegral::move_intrinsics(const Covariance& F, const ByIntrinsics& more) {
  ByIntrinsics moved = more;
  for (int j = 0; j < Intrinsics::kRows; ++j)
    for (int k = 0; k < 9; ++k)
      for (int i = 0; i < 9; ++i) moved(i, j) += F(i, k) * by_intrinsics_(k, j);
  by_intrinsics_ = moved;
}

/// With G = -dt R J_l(w dt) and  V = -dt ([R a_0]x + [R+ a_1]x) / 2:
///
///          phi      v      p    b_g       b_a
///   phi |  I                    G D_w                        |
///   v   |  V        I           V_g D_w   V_a D_a            |   V_g = -dt [R+ a_1]x G / 2,   V_a = -dt (R + R+) / 2
///   p   |  dt V/2   dt I   I    dt V_g/2  dt/2 of the above  |
///
/// White noise of a reading does in the step what a bias does, and an error of the intrinsics what -dD (reading - bias) of one would.
void Preintegral::add(Scalar dt, const ImuReading& from, const ImuReading& to, Scalar gyro_more, Scalar accel_more) {
  const Vec3 g = (from.gyro + to.gyro) / 2 - gyro_bias_;
  const Vec3 turn = (intrinsics_.D_w * g) * dt;
  const Mat3 R_1 = R_ * exp_so3(turn).toRotationMatrix();
  const Vec3 f_0 = from.accel - accel_bias_, f_1 = to.accel - accel_bias_;
  const Vec3 a_0 = R_ * (intrinsics_.D_a * f_0), a_1 = R_1 * (intrinsics_.D_a * f_1);
  const Vec3 a = (a_0 + a_1) / 2;
  const Scalar half = dt / 2;

  const Mat3 by_rate = -dt * R_.lazyProduct(left_jacobian_so3(turn));
  const Mat3 V = -half * hat(a_0 + a_1), G = by_rate.lazyProduct(intrinsics_.D_w);
  const Mat3 V_g = -half * hat(a_1).lazyProduct(G), V_a = (-half * (R_ + R_1)).lazyProduct(intrinsics_.D_a);
  Covariance F = Covariance::Identity();
  F.block<3, 3>(kPhi, kGyroBias) = G;
  F.block<3, 3>(kVelocity, kPhi) = V;
  F.block<3, 3>(kVelocity, kGyroBias) = V_g;
  F.block<3, 3>(kVelocity, kAccelBias) = V_a;
  F.block<3, 3>(kPosition, kPhi) = half * V;
  F.block<3, 3>(kPosition, kVelocity) = dt * Mat3::Identity();
  F.block<3, 3>(kPosition, kGyroBias) = half * V_g;
  F.block<3, 3>(kPosition, kAccelBias) = half * V_a;
  move_errors(F);
  if (intrinsics_.open) {
    ByIntrinsics more;
    const auto by_gyro = Intrinsics::gyro_by_errors(g);
    more << -by_rate.lazyProduct(by_gyro), Eigen::Matrix<Scalar, 3, Intrinsics::kAccelRows>::Zero(),
        half * hat(a_1).lazyProduct(by_rate.lazyProduct(by_gyro)),
        half * (R_.lazyProduct(Intrinsics::accel_by_errors(f_0)) + R_1.lazyProduct(Intrinsics::accel_by_errors(f_1))),
        Eigen::Matrix<Scalar, 3, Intrinsics::kRows>::Zero();
    more.bottomRows<3>() = half * more.middleRows<3>(kVelocity);
    move_intrinsics(F, more);
  }

  Eigen::Matrix<Scalar, 9, 6> B;
  B << G, Mat3::Zero(), V_g, V_a, half * V_g, half * V_a;
  const Scalar gyro = (noise_.gyro_density * noise_.gyro_density + gyro_more) / dt;
  const Scalar accel = (noise_.accel_density * noise_.accel_density + accel_more) / dt;
  for (int k = 0; k < 6; ++k)
    for (int j = 0; j < 9; ++j)
      for (int i = 0; i < 9; ++i) S_(i, j) += (k < 3 ? gyro : accel) * B(i, k) * B(j, k);
  for (int i = 0; i < 3; ++i) {
    S_(kGyroBias + i, kGyroBias + i) += noise_.gyro_walk * noise_.gyro_walk * dt;
    S_(kAccelBias + i, kAccelBias + i) += noise_.accel_walk * noise_.accel_walk * dt;
  }
  p_ += v_ * dt + a * (dt * half);
  v_ += a * dt;
  R_ = R_1;
  dt_ += dt;
}

void Preintegral::set_ends(const ImuReading& from, const ImuReading& to) {
  const Vec3 w_0 = rate(from.gyro), w_1 = rate(to.gyro);
  const Vec3 a_0 = intrinsics_.D_a * (from.accel - accel_bias_), a_1 = intrinsics_.D_a * (to.accel - accel_bias_);
  by_delay_ << w_0 - R_ * w_1, w_0.cross(v_) + a_0 - R_ * a_1, w_0.cross(p_) + dt_ * a_0 - v_;
}

void Preintegral::coast(Scalar dt, const Vec3& w_B, const Vec3& f_B, Scalar angular_density, Scalar linear_density) {
  const Vec3 turn = w_B * dt;
  const Mat3 by_rate = -dt * R_.lazyProduct(left_jacobian_so3(turn)), G = by_rate.lazyProduct(intrinsics_.D_w);
  Covariance F = Covariance::Identity();
  F.block<3, 3>(kPhi, kGyroBias) = G;
  F.block<3, 3>(kPosition, kVelocity) = dt * Mat3::Identity();
  move_errors(F);
  if (intrinsics_.open) {
    ByIntrinsics more = ByIntrinsics::Zero();
    more.topLeftCorner<3, Intrinsics::kGyroRows>() =
        -by_rate.lazyProduct(Intrinsics::gyro_by_errors(intrinsics_.D_w.inverse() * w_B));
    move_intrinsics(F, more);
  }
  const Scalar b = angular_density * angular_density, a = linear_density * linear_density;
  const Scalar d2 = dt * dt / 2, d3 = dt * dt * dt / 3;
  for (int i = 0; i < 3; ++i) {
    S_(kPhi + i, kPhi + i) += b * d3;
    S_(kVelocity + i, kVelocity + i) += a * dt;
    S_(kPosition + i, kPosition + i) += a * d3;
    S_(kVelocity + i, kPosition + i) += a * d2;
    S_(kPosition + i, kVelocity + i) += a * d2;
    S_(kGyroBias + i, kGyroBias + i) += noise_.gyro_walk * noise_.gyro_walk * dt;
    S_(kAccelBias + i, kAccelBias + i) += noise_.accel_walk * noise_.accel_walk * dt;
  }
  p_ += v_ * dt + f_B * (dt * dt / 2);
  v_ += f_B * dt;
  R_ = R_ * exp_so3(turn).toRotationMatrix();
  dt_ += dt;
}

}  // namespace pf
