#pragma once

#include "base/eigen.h"
#include "model/intrinsics.h"

/// Inertial samples between two times, integrated once, in the axes B of the unit at the first of them (lib/docs/theory/inertial.md).

namespace pf {

/// What one inertial unit is known to do.
struct ImuNoise {
  Scalar gyro_density = 0;   ///< [rad/s/sqrt(Hz)]
  Scalar accel_density = 0;  ///< [m/s^2/sqrt(Hz)]
  Scalar gyro_walk = 0;      ///< [rad/s^2/sqrt(Hz)]
  Scalar accel_walk = 0;     ///< [m/s^3/sqrt(Hz)]
};

/// Angular velocity [rad/s] and specific force [m/s^2] in the unit's axes, at a time.
struct ImuReading {
  Vec3 gyro = Vec3::Zero();
  Vec3 accel = Vec3::Zero();
};

/// How the unit has rotated, and what its specific force has done to velocity and position, with first-order errors
/// (phi, v, p, b_g, b_a), in the axes at the beginning: R_true = Exp(phi) R.
class Preintegral {
 public:
  static constexpr int kRows = 15, kPhi = 0, kVelocity = 3, kPosition = 6, kGyroBias = 9, kAccelBias = 12;
  using Covariance = Eigen::Matrix<Scalar, kRows, kRows>;
  using ByBias = Eigen::Matrix<Scalar, 9, 6>;
  using ByDelay = Eigen::Matrix<Scalar, 9, 1>;
  using ByIntrinsics = Eigen::Matrix<Scalar, 9, Intrinsics::kRows>;

  Preintegral(const ImuNoise& noise, const Vec3& gyro_bias, const Vec3& accel_bias,
              const Intrinsics& intrinsics = Intrinsics())
      : noise_(noise), gyro_bias_(gyro_bias), accel_bias_(accel_bias), intrinsics_(intrinsics) {}

  /// J S J^T, in loops that stay loops: unrolled, each use is some 10 kB of code.
  static Covariance transformed(const Covariance& J, const Covariance& S);

  /// From one reading to the next, dt > 0 [s] later, by the mid-point rule:
  ///
  ///   R+ = R Exp(D_w ((g_0 + g_1)/2 - b_g) dt),   a = (R D_a (a_0 - b_a) + R+ D_a (a_1 - b_a)) / 2
  ///   v+ = v + a dt,   p+ = p + v dt + a dt^2 / 2
  ///
  /// gyro_more, accel_more: squared densities on top of those of the unit.
  void add(Scalar dt, const ImuReading& from, const ImuReading& to, Scalar gyro_more = 0, Scalar accel_more = 0);
  /// Without readings: the rotation goes on as w_B [rad/s] in axes at the end, the specific force is f_B in axes at the beginning.
  /// angular_density [rad/s^2/sqrt(Hz)], linear_density [m/s^2/sqrt(Hz)]: of the accelerations, which nothing measures.
  void coast(Scalar dt, const Vec3& w_B, const Vec3& f_B, Scalar angular_density, Scalar linear_density);

  Scalar dt() const { return dt_; }
  const Vec3& gyro_bias() const { return gyro_bias_; }
  const Vec3& accel_bias() const { return accel_bias_; }
  const Intrinsics& intrinsics() const { return intrinsics_; }
  /// Angular velocity of a gyroscope's reading.
  Vec3 rate(const Vec3& gyro) const { return intrinsics_.D_w * (gyro - gyro_bias_); }
  const Mat3& R() const { return R_; }
  const Vec3& v() const { return v_; }
  const Vec3& p() const { return p_; }
  /// Of (phi, v, p) by (b_g, b_a).
  const ByBias& by_bias() const { return D_; }
  /// The same by the errors of the intrinsics; zero where these are known.
  const ByIntrinsics& by_intrinsics() const { return by_intrinsics_; }
  /// The readings at both ends, for the Jacobian by the delay.
  void set_ends(const ImuReading& from, const ImuReading& to);
  /// Of (phi, v, p) by a delay that is longer by e: both ends are e earlier on the clock of the samples. With w and a without bias, at the
  /// beginning (0) and at the end (1); zero where set_ends was not called.
  ///
  ///   phi: w_0 - R w_1,   v: [w_0]x v + a_0 - R a_1,   p: [w_0]x p + T a_0 - v
  const ByDelay& by_delay() const { return by_delay_; }
  const Covariance& covariance() const { return S_; }

 private:
  void move_errors(const Covariance& F);
  void move_intrinsics(const Covariance& F, const ByIntrinsics& more);

  ImuNoise noise_;
  Vec3 gyro_bias_, accel_bias_;
  Intrinsics intrinsics_;
  Scalar dt_ = 0;
  Mat3 R_ = Mat3::Identity();
  Vec3 v_ = Vec3::Zero();
  Vec3 p_ = Vec3::Zero();
  ByBias D_ = ByBias::Zero();
  ByIntrinsics by_intrinsics_ = ByIntrinsics::Zero();
  ByDelay by_delay_ = ByDelay::Zero();
  Covariance S_ = Covariance::Zero();
};

}  // namespace pf
