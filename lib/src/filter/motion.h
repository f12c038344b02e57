#pragma once

#include "model/state.h"

namespace pf {

/// White-noise densities of the motion models.
struct MotionNoise {
  /// Constant velocity: [m/s^2/sqrt(Hz)]; constant acceleration: [m/s^3/sqrt(Hz)]; constant position: [m/sqrt(s)]
  Scalar linear;
  Scalar angular;  ///< [rad/s^2/sqrt(Hz)]; constant position: [rad/sqrt(s)]
};

/// Prediction of a motion model: the body afterwards, the transition of its error and the noise that it gains, row-major, leading dimension
/// dim: the rows of the parts that move. x+ = F x + by_intrinsics c + noise, c the errors of an inertial unit's intrinsics, which stay.
struct Transition {
  Body mean;
  Bend bend;  ///< at its time
  int dim;
  Scalar F[BodyLayout::kMaxDynamicRows * BodyLayout::kMaxDynamicRows];
  Scalar Q[BodyLayout::kMaxDynamicRows * BodyLayout::kMaxDynamicRows];
  bool has_intrinsics = false;                                            ///< otherwise nothing depends on them
  Scalar by_intrinsics[BodyLayout::kMaxDynamicRows * Intrinsics::kRows];  ///< dim x kRows
};

/// Constant velocity with white accelerations over dt > 0 [s].
///
///   R+ = R Exp(w dt),  p+ = p + v dt,  v+ = v,  w+ = w
///   theta+ = theta + J dt e_w,  e_p+ = e_p + dt e_v        J = R J_l(w dt)
///   Q: velocity q^2 dt I, position q^2 dt^3/3 I, between them q^2 dt^2/2 I; the same for the rotation, through J
///
/// Rotating or scaling the world before or after is the same, so gauge directions go to gauge directions.
void predict_constant_velocity(const Body& body, const BodyLayout& layout, Scalar dt, const MotionNoise& noise,
                               Transition* transition);

/// Constant acceleration and angular velocity in camera axes with white jerk and angular acceleration over dt > 0 [s]. With v_C = R^T v
/// and the integrals S, T of turn_integrals.h at w dt:
///
///   R+ = R Exp(w dt),   p+ = p + R d,   d = S v_C dt + T a dt^2/2,   v+ = R+ (v_C + a dt),   w+ = w,   a+ = a
///   theta+ = theta + J e_w dt,   J = R S,   E = R+ R^T
///   e_p+ = e_p + (R S R^T [v]x dt - [R d]x) theta + R S R^T e_v dt + R (dd/dw) e_w + R T e_a dt^2/2
///   e_v+ = (E [v]x - [v+]x) theta + E e_v - [v+]x J e_w dt + R+ e_a dt
///   Q: acceleration q^2 dt I, velocity q^2 dt^3/3 I, position q^2 dt^5/20 I, between them q^2 dt^2/2 R+ and so on; the rotation and the
///   angular velocity as with constant velocity; what rotates the camera rotates its velocity: (-[v+]x) of the rotation's noise
///
/// Without accelerations the camera flies along the arc of its own rotation. Rotating or scaling the world before or after is the same.
/// src Servant 2008 (2), (3): the state has the camera in the world in place of the world in the camera; the velocity is kept in axes of
/// the world, as with every other model, and the error of the rotation is on the world's side.
void predict_constant_acceleration(const Body& body, const BodyLayout& layout, Scalar dt, const MotionNoise& noise,
                                   Transition* transition);

/// An acceleration of which nothing is measured goes back to its prior, zero with standard deviation sigma, by a factor f of 0 .. 1:
///
///   a+ = f a,   e_a+ = f e_a,   Q = (1 - f^2) sigma^2 I
void damp_acceleration(const Body& body, const BodyLayout& layout, Scalar factor, Scalar sigma, Transition* transition);

/// Known change of the velocities, in camera axes:
///
///   v_W+ = v_W + R dv,   w_C+ = w_C + dw,   e_v+ = e_v - [R dv]x theta
void change_velocity(const Body& body, const BodyLayout& layout, const Vec3& dv_C, const Vec3& dw_C,
                     Transition* transition);

/// Speeds m = (v, w) that shrink by a factor f of 0 .. 1 and keep their second moment: what leaves the mean becomes noise,
///
///   m+ = f m,   e_m+ = f e_m,   Q = (1 - f^2)(P_m + m m^T)
///
/// so that a speed that goes on and one that ends are both expected. P_m 6x6 is their covariance. rate: w, or what stands for it in the
/// rows behind the velocity.
void damp_speed(const Body& body, const BodyLayout& layout, Scalar factor, const Vec3& rate, const Mat6& P_m,
                Transition* transition);

/// Random walk of the pose (Gee 2007, eq 1): R+ = Exp(w_theta) R, p+ = p + w_p, with variances density^2 dt.
/// The paper's Euler angles become a rotation vector, which is the same to first order in the noise.
void predict_constant_position(const Body& body, const BodyLayout& layout, Scalar dt, const MotionNoise& noise,
                               Transition* transition);

}  // namespace pf
