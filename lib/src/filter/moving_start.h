#pragma once

#include "filter/preintegral.h"

/// Scale, gravity and the accelerometer's bias from a moving camera: poses up to scale and samples between them
/// (lib/docs/theory/inertial.md).

namespace pf {

/// A pose of the camera in a map up to scale, and the integrals of the samples since the pose before, in W. R: R_WB of the one before.
struct MovingPose {
  Scalar dt = 0;             ///< since the one before [s]
  Vec3 p_W = Vec3::Zero();   ///< of the camera, in units of the map
  Scalar sigma = 0;          ///< of each of its coordinates, white
  Vec3 m_W = Vec3::Zero();   ///< from the camera to the unit's origin [m]
  Vec3 Rv = Vec3::Zero();    ///< R dv
  Vec3 Rp = Vec3::Zero();    ///< R dp
  Mat3 Rv_b = Mat3::Zero();  ///< of R dv by the accelerometer's bias
  Mat3 Rp_b = Mat3::Zero();  ///< of R dp, the same
};

/// What is known of the body at the first of the poses, where it was at rest: R_WB (D_a a - D_a b_a) + g = 0, and no velocity.
struct MovingRest {
  Vec3 f_W = Vec3::Zero();  ///< mean specific force, D_a a in W [m/s^2]
  Mat3 f_b = Mat3::Zero();  ///< of f_W by the accelerometer's bias
  Scalar sigma_force = 1;   ///< of each axis [m/s^2]
  Scalar sigma_speed = 1;   ///< of each axis of the velocity, in units of the map [1/s]
};

struct MovingStartNoise {
  Scalar gravity = 0;        ///< [m/s^2]
  Scalar drift = 0;          ///< of p_W, as the points that it is known by change, in units of the map [/sqrt(s)]
  Scalar accel_density = 0;  ///< white, of the accelerometer [m/s^2/sqrt(Hz)]
  Scalar tilt_density = 0;   ///< of the poses' rotations, which tilts gravity in them [rad/sqrt(s)]
  Scalar turn = 0;           ///< of the constant rate at which the poses' rotations drift from the truth [rad/s]
  Scalar accel_bias = 0;     ///< prior sigma of each axis [m/s^2]
  /// Covariance of the errors of the accelerometer's intrinsics (model/intrinsics.h); null where these are exact.
  using OfForce = Eigen::Matrix<Scalar, Intrinsics::kAccelRows, Intrinsics::kAccelRows>;
  const OfForce* of_force = nullptr;
  const MovingRest* rest = nullptr;  ///< null where the body moved at the first pose, or may have
};

/// What was found. Covariance over (log scale, d, b_a): d as in model/body.h.
struct MovingSolution {
  static constexpr int kRows = 6;
  using Covariance = Eigen::Matrix<Scalar, kRows, kRows>;

  Scalar scale = 1;  ///< metres for a unit of the map
  Quat q_WG = Quat::Identity();
  Vec3 accel_bias = Vec3::Zero();  ///< beside the one that the samples were integrated with
  Covariance covariance = Covariance::Zero();
  /// Jacobian of its errors by the rate at which the poses' rotations drift; the covariance includes it, with turn_variance.
  Eigen::Matrix<Scalar, kRows, 3> by_turn = Eigen::Matrix<Scalar, kRows, 3>::Zero();
  Scalar turn_variance = 0;  ///< of each axis [rad^2/s^2]
  Scalar span = 0;           ///< of the poses [s]
  /// The same by the errors of the accelerometer's intrinsics, and their part of the covariance.
  template <int kCount>
  using ByForce = Eigen::Matrix<Scalar, kCount, Intrinsics::kAccelRows>;
  ByForce<kRows> by_force = ByForce<kRows>::Zero();
  Covariance of_force = Covariance::Zero();
  Scalar misfit = 0;  ///< chi-square over its degrees of freedom

  Scalar sigma_scale() const { return std::sqrt(covariance(0, 0)); }  ///< relative
  Scalar sigma_gravity() const { return std::sqrt(covariance(1, 1) + covariance(2, 2)); }
  /// The same without the part of the intrinsics, which a longer motion before the start would not reduce.
  Scalar sigma_scale_by_motion() const { return std::sqrt(covariance(0, 0) - of_force(0, 0)); }
  Scalar sigma_gravity_by_motion() const {
    return std::sqrt(covariance(1, 1) + covariance(2, 2) - of_force(1, 1) - of_force(2, 2));
  }
};

inline constexpr int kMaxMovingPoses = 96;

/// With S_k, B_k the double sums over R dv, R dp and their Jacobians, t_k the time since the first pose, and u the units of the map in a
/// metre:
///
///   p_k - p_0 = u (v_0 t_k + g t_k^2 / 2 + S_k + B_k b_a - (m_k - m_0))
///
/// linear in u, u v_0, u g and u b_a. What is noisy, the poses, stands alone: as a factor of the scale it would draw that to zero. First
/// without b_a and with g of any length, then refined with |g| imposed and the prior of b_a: g = gravity R_WG e_z,
/// dg = gravity (-R_WG e_y, R_WG e_x) d. Residuals are whitened by
///
///   C_jk = sigma_0^2 + sigma_k^2 delta_jk + q_d^2 min(t_j, t_k) + (u q_a)^2 G2_jk + (u gravity)^2 (q_r^2 G3_jk + q_t^2 h_j h_k)
///
/// Gn: covariance of an n times integrated white noise; h = t^3 / 6 - T t^2 / 4: gravity in poses whose rotation drifts, right at T / 2. A
/// rate rho of that, theta = rho (t - T / 2), leaves r = u h [g]x rho and an error by_turn rho of the solution. With many poses, rows are
/// means over a few neighbours. A rest at the first pose adds six rows, with h = -T / 2 and 0,
///
///   0 = u (f_W + f_b b_a + g),   0 = u v_0
///
/// A misfit above one widens the covariance. False where there are too few poses or the system is singular.
bool solve_moving_start(const MovingPose* pose, int count, const MovingStartNoise& noise, MovingSolution* out);

}  // namespace pf
