#include <cmath>

#include "filter/inertial_motion.h"
#include "filter/inertial_rows.h"
#include "geometry/so3.h"

/// Begins and ends the prediction by samples, and takes up the readings of a rest.

namespace pf {

using namespace inertial_rows;

namespace {

/// The rows of the gyro's bias by D_w^-1 dD_w D_w^-1 w_B, with this sign: what the intrinsics make of the rate, which those rows stand for
/// where samples do not move the body.
void set_rate_by_intrinsics(const Body& body, const Mounting& mounting, Scalar sign, const PartRows& rows,
                            Transition* transition) {
  if (rows.intrinsics < 0) return;
  const Mat3 D_inverse = sign * mounting.intrinsics.D_w.inverse();
  set_by_intrinsics(transition, rows.gyro, 0,
                    Eigen::Matrix<Scalar, 3, Intrinsics::kGyroRows>(
                        D_inverse.lazyProduct(Intrinsics::gyro_by_errors(mounting.reading_of(body.w_C)))));
}

}  // namespace

void begin_without_samples(const Body& body, const BodyLayout& layout, const Mounting& mounting, Scalar sigma_rate,
                           bool anew, Scalar sigma_speed, Transition* transition) {
  const PartRows rows(layout);
  clear(transition, body, rows.dim);
  if (anew) {
    forget_rows(transition, rows.velocity, 3);
    forget_rows(transition, rows.gyro, 3);
    add_variance(transition, rows.velocity, 3, sigma_speed);
  } else {
    set_rate_by_intrinsics(body, mounting, Scalar(-1), rows, transition);
  }
  add_variance(transition, rows.gyro, 3, sigma_rate);
}

void begin_with_samples(const Body& body, const BodyLayout& layout, const Mounting& mounting, const FreshReading& fresh,
                        Transition* transition) {
  const PartRows rows(layout);
  clear(transition, body, rows.dim);
  transition->mean.gyro_bias = fresh.gyro - mounting.reading_of(body.w_C);
  set_rate_by_intrinsics(body, mounting, Scalar(1), rows, transition);
  add_variance(transition, rows.gyro, 3, fresh.sigma_gyro);
  if (!fresh.anew) return;
  transition->mean.accel_bias.setZero();
  transition->mean.q_WG = turn_z_to(fresh.gravity_W.normalized());
  forget_rows(transition, rows.accel, 5);  // gravity follows
  add_variance(transition, rows.accel, 3, fresh.sigma_accel_bias);
  add_variance(transition, rows.gravity, 2, fresh.sigma_gravity);
  set_gravity_by_rotation(rows, false, transition);
}

void begin_mounting(const Body& body, const BodyLayout& layout, const Mat3& turned, Scalar sigma_turn,
                    Scalar sigma_delay, Transition* transition) {
  const PartRows rows(layout);
  clear(transition, body, rows.dim);
  set_block<3>(transition->F, rows.dim, rows.gyro, rows.gyro, turned);
  if (rows.turn >= 0 && sigma_turn > Scalar(0)) {
    forget_rows(transition, rows.turn, 3);
    add_variance(transition, rows.turn, 3, sigma_turn);
  }
  if (rows.delay >= 0 && sigma_delay > Scalar(0)) {
    forget_rows(transition, rows.delay, 1);
    add_variance(transition, rows.delay, 1, sigma_delay);
  }
}

void predict_at_rest(const Body& body, const BodyLayout& layout, Scalar dt, const ImuNoise& noise, Scalar sigma_rad,
                     Scalar sigma_m, Transition* transition) {
  const PartRows rows(layout);
  clear(transition, body, rows.dim);
  transition->mean.w_C.setZero();
  const Scalar root = std::sqrt(dt);
  add_variance(transition, Body::kTheta, 3, sigma_rad);
  add_variance(transition, Body::kPosition, 3, sigma_m);
  add_variance(transition, rows.gyro, 3, noise.gyro_walk * root);
  add_variance(transition, rows.accel, 3, noise.accel_walk * root);
}

void begin_speed(const Body& body, const BodyLayout& layout, Scalar sigma_speed, Transition* transition) {
  const PartRows rows(layout);
  clear(transition, body, rows.dim);
  transition->mean.v_W.setZero();
  forget_rows(transition, rows.velocity, 3);
  add_variance(transition, rows.velocity, 3, sigma_speed);
}

void allow_for_turned_gravity(const Body& body, const BodyLayout& layout, Scalar variance, Transition* transition) {
  const PartRows rows(layout);
  clear(transition, body, rows.dim);
  add_variance(transition, rows.gravity, 2, variance / 2);
}

void begin_at_rest(const Body& body, const BodyLayout& layout, const Mounting& mounting, const RestReading& rest,
                   Transition* transition) {
  const PartRows rows(layout);
  clear(transition, body, rows.dim);
  Body& mean = transition->mean;
  Scalar* Q = transition->Q;
  const Mat3 R = body.q_WC.toRotationMatrix() * mounting.R_CB;
  const Intrinsics& intrinsics = mounting.intrinsics;
  const Vec3 accel = intrinsics.D_a * rest.accel;
  const Scalar length = accel.norm();
  const Vec3 f_B = accel / length, u = -(R * f_B);
  mean.v_W.setZero();
  mean.w_C.setZero();
  mean.gyro_bias = rest.gyro;
  const Mat3 D_inverse = intrinsics.D_a.inverse();
  mean.accel_bias = D_inverse * ((length - rest.gravity) * f_B);
  mean.q_WG = turn_z_to(u);

  forget_rows(transition, rows.velocity, rows.gravity + 2 - rows.velocity);  // velocity, biases and gravity begin anew
  const Mat3 along = f_B * f_B.transpose(), across = Mat3::Identity() - along;
  const Mat3 open = rest.sigma_accel_bias * rest.sigma_accel_bias * across;
  const Scalar noise = rest.sigma_accel * rest.sigma_accel;
  const Eigen::Matrix<Scalar, 2, 3> E_t = set_gravity_by_rotation(rows, true, transition);
  const Eigen::Matrix<Scalar, 2, 3> K = E_t * hat(u) * R / rest.gravity;  // d by e_b and n
  const Mat3 Q_accel = open + noise * along;
  const Eigen::Matrix<Scalar, 2, 3> Q_cross = K * open;
  if (rows.intrinsics >= 0) {
    const auto by_force = Intrinsics::accel_by_errors(D_inverse * (rest.gravity * f_B));
    set_by_intrinsics(transition, rows.accel, Intrinsics::kGyroRows,
                      Eigen::Matrix<Scalar, 3, Intrinsics::kAccelRows>(D_inverse * (along * by_force)));
    set_by_intrinsics(transition, rows.gravity, Intrinsics::kGyroRows,
                      Eigen::Matrix<Scalar, 2, Intrinsics::kAccelRows>(-K * by_force));
  }
  const Mat2 Q_gravity = Q_cross * K.transpose() + noise * K * K.transpose();
  for (int i = 0; i < 3; ++i) {
    Q[(rows.velocity + i) * rows.dim + rows.velocity + i] = rest.sigma_speed * rest.sigma_speed;
    Q[(rows.gyro + i) * rows.dim + rows.gyro + i] = rest.sigma_gyro * rest.sigma_gyro;
    for (int j = 0; j < 3; ++j) Q[(rows.accel + i) * rows.dim + rows.accel + j] = Q_accel(i, j);
    for (int j = 0; j < 2; ++j) {
      Q[(rows.gravity + j) * rows.dim + rows.accel + i] = Q_cross(j, i);
      Q[(rows.accel + i) * rows.dim + rows.gravity + j] = Q_cross(j, i);
    }
  }
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) Q[(rows.gravity + i) * rows.dim + rows.gravity + j] = Q_gravity(i, j);
}

}  // namespace pf
