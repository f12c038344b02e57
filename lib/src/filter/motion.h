#pragma once

#include "filter/state.h"

namespace pf {

/// White-noise densities of the motion models.
struct MotionNoise {
  Scalar linear;   ///< constant velocity: [m/s^2/sqrt(Hz)]; constant position: [m/sqrt(s)]
  Scalar angular;  ///< constant velocity: [rad/s^2/sqrt(Hz)]; constant position: [rad/sqrt(s)]
};

/// Transition of the body's error and the noise that it gains, row-major, leading dimension dim.
struct Transition {
  int dim;
  Scalar F[Body::kMaxDim * Body::kMaxDim];
  Scalar Q[Body::kMaxDim * Body::kMaxDim];
};

/// Constant velocity with white accelerations over dt > 0 [s].
///
///   R+ = R Exp(w dt),  p+ = p + v dt,  v+ = v,  w+ = w
///   theta+ = theta + J dt e_w,  e_p+ = e_p + dt e_v        J = R J_l(w dt)
///   Q: velocity q^2 dt I, position q^2 dt^3/3 I, between them q^2 dt^2/2 I; likewise for the rotation, through J
///
/// Turning or scaling the world before and after is the same thing, so gauge directions go to gauge directions.
void predict_constant_velocity(Body& body, Scalar dt, const MotionNoise& noise, Transition* transition);

/// Speeds m = (v, w) that shrink by a factor f of 0 .. 1 and keep their second moment: what leaves the mean becomes noise,
///
///   m+ = f m,   e_m+ = f e_m,   Q = (1 - f^2)(P_m + m m^T)
///
/// so that a speed that goes on and one that ends are both expected. P_m 6x6 is their covariance.
void damp_speed(Body& body, Scalar factor, const Mat6& P_m, Transition* transition);

/// Random walk of the pose (Gee 2007, eq 1): R+ = Exp(w_theta) R, p+ = p + w_p, with variances density^2 dt.
/// The paper's Euler angles become a rotation vector, which is the same to first order in the noise.
void predict_constant_position(Body& body, Scalar dt, const MotionNoise& noise, Transition* transition);

}  // namespace pf
