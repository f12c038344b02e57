#pragma once

#include "filter/motion.h"
#include "filter/preintegral.h"

/// The inertial motion model: how a body moves by the samples of its inertial unit (lib/docs/theory/inertial.md).

namespace pf {

/// With R = R_WB, the unit's origin at m in C, m_W = R_WC m, and g_W = gravity times R_WG e_z:
///
///   R+ = R dR,   v+ = v + g_W T + R dv,   p_B+ = p_B + v T + g_W T^2 / 2 + R dp,   p_B = p_C + m_W
///
///   theta+ = theta + R e_phi
///   e_v+   = e_v - [R dv]x theta + R e_dv + T E d                          E = gravity (-R_WG e_y, R_WG e_x)
///   e_p+   = e_p + ([m_W+]x - [m_W]x - [R dp]x) theta + T e_v + R e_dp + [m_W+]x R e_phi + T^2/2 E d
///
/// and where the layout has them, by the mounting (mu, e_m) and by a delay that is longer by e, through (e_phi, e_dv, e_dp) of by_delay:
///
///   theta+ += (R_WC - R_WC+) mu,   e_v+ -= [R dv]x R_WC mu
///   e_p+   += ([m_W+]x (R_WC - R_WC+) - [R dp]x R_WC) mu + (R_WC - R_WC+) e_m
///
/// gravity [m/s^2]. The mean's w_C is left as it is.
/// By the errors of the intrinsics, where the layout has them, through (e_phi, e_dv, e_dp) of by_intrinsics, as by the biases.
void predict_inertial(const Body& body, const BodyLayout& layout, const Mounting& mounting, const Preintegral& samples,
                      Scalar gravity, Transition* transition);

/// While the scale or gravity are not known: rotation from the gyro, translation with white accelerations.
void predict_rotation_only(const Body& body, const BodyLayout& layout, const Mounting& mounting,
                           const Preintegral& samples, Scalar linear_density, Transition* transition);

/// Without samples: constant velocity with white accelerations, as in motion.h. The angular velocity stands in the rows of the gyro's
/// bias (State::uses_samples), e_w = -D_w e_b, both in the axes of the unit:
///
///   R_WB+ = R_WB Exp(w_B T),   v+ = v,   p_B+ = p_B + v T
///   theta+ = theta - T R J_l(w_B T) D_w e_b,   Q: as that of constant velocity, through the same J
void predict_without_samples(const Body& body, const BodyLayout& layout, const Mounting& mounting, Scalar dt,
                             const MotionNoise& noise, Transition* transition);

/// From here on without samples. sigma_rate [rad/s]: of the angular velocity, beside the error of the bias that it was known with; with
/// `anew` it and the velocity, with sigma_speed [m/s], begin anew about their means.
void begin_without_samples(const Body& body, const BodyLayout& layout, const Mounting& mounting, Scalar sigma_rate,
                           bool anew, Scalar sigma_speed, Transition* transition);

/// What takes back a transition that was made, and makes another from where it began:
///
///   F <- F F_made^-1,   Q <- Q - F Q_made F^T   (with the new F), which is a covariance only together with P
///
/// F_made - I is nilpotent, as in the models above: biases and gravity move the rotation and the velocity, these the position.
void replace_transition(const Transition& made, Transition* transition);

/// Readings of samples that are used again after a gap.
struct FreshReading {
  Vec3 gyro = Vec3::Zero();  ///< at the body's time
  Scalar sigma_gyro = 0;     ///< [rad/s] of each axis
  bool anew = false;         ///< gravity and the accelerometer's bias begin anew too, as below
  Vec3 gravity_W = Vec3::Zero();
  Scalar sigma_gravity = 0;     ///< [rad] of its direction
  Scalar sigma_accel_bias = 0;  ///< [m/s^2]
};

/// From here on by samples again: b = gyro - D_w^-1 w_B, so that the error of the one is that of the other, but for what the intrinsics
/// do to both (here as where samples end),
///
///   e_b+ = e_b + D_w^-1 dD_w D_w^-1 w_B + n,   anew:  e_a+ = n_a,  d+ = E^T theta + n_g        E = (R_WG e_x, R_WG e_y)
void begin_with_samples(const Body& body, const BodyLayout& layout, const Mounting& mounting, const FreshReading& fresh,
                        Transition* transition);

/// The unit's axes and its delay become known anew, each with its sigma where that is above 0, while samples do not move the body: the rows
/// of the gyro's bias are those of the angular velocity in the old axes, and go over to the new ones.
///
/// turned: R_CB_newᵀ R_CB_old
void begin_mounting(const Body& body, const BodyLayout& layout, const Mat3& turned, Scalar sigma_turn,
                    Scalar sigma_delay, Transition* transition);

/// Readings of a second at rest: means over it.
struct RestReading {
  Vec3 gyro = Vec3::Zero();   ///< [rad/s]
  Vec3 accel = Vec3::Zero();  ///< [m/s^2]
  Scalar sigma_gyro = 0;      ///< of each axis of the mean
  Scalar sigma_accel = 0;
  Scalar sigma_speed = 0;       ///< [m/s] at which it may still have moved
  Scalar sigma_accel_bias = 0;  ///< [m/s^2] of a bias that nothing else is known of
  Scalar gravity = 0;           ///< [m/s^2]
};

/// Readings of a frame while a rest goes on: means since the last frame.
struct StillReading {
  Vec3 gyro = Vec3::Zero();   ///< [rad/s]
  Vec3 accel = Vec3::Zero();  ///< [m/s^2]
  Scalar sigma_gyro = 0;      ///< of each axis
  Scalar sigma_accel = 0;
};

/// While a rest goes on: nothing moves, and biases walk. The samples are no motion then but measurements (Filter::predict_still).
/// sigma_rad, sigma_m: what the pose may have moved beside that.
void predict_at_rest(const Body& body, const BodyLayout& layout, Scalar dt, const ImuNoise& noise, Scalar sigma_rad,
                     Scalar sigma_m, Transition* transition);

/// A rest begins or ends: the velocity is zero within sigma_speed [m/s].
void begin_speed(const Body& body, const BodyLayout& layout, Scalar sigma_speed, Transition* transition);

/// Noise for the second-order term of a rest's reading in gravity and the unit's axes. A rotation mu of the axes, with variance s^2 about
/// each, has a part b along gravity and a part a across it, which leave [a]x b / 2:  Q = s^4 / 4 in both rows of gravity.
void allow_for_turned_gravity(const Body& body, const BodyLayout& layout, Scalar variance, Transition* transition);

/// The gyro's bias is its reading, the velocity zero. Gravity and the accelerometer's bias become known together: with u = -R a / |a| in W,
///
///   g_W + R (b_a + n) = -R a:   b_a = (|a| - gravity) a / |a|,   gravity's direction is u
///   d = E^T (u x R (e_b + n)) / gravity + E^T theta                        E = (R_WG e_x, R_WG e_y)
///
/// so that of e_b the two rows across gravity stay open, and hang together with d, and the one along it is n. Where the unit's axes are
/// estimated, theta + R_WC mu stands in place of theta. With intrinsics, D_a (a - b_a) stands in place of a - b_a, and -dD_a (a - b_a)
/// beside e_b + n.
void begin_at_rest(const Body& body, const BodyLayout& layout, const Mounting& mounting, const RestReading& rest,
                   Transition* transition);

}  // namespace pf
