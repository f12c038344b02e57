#include "filter/motion.h"

#include "geometry/so3.h"
#include "geometry/turn_integrals.h"

namespace pf {
namespace {

constexpr Scalar kThrice =
    Scalar(0.05);  ///< variance of white noise that is integrated three times: int_0^1 (s^2 / 2)^2 ds

void clear(Transition* t, const Body& body, const BodyLayout& layout) {
  const int dim = layout.dynamic_rows();
  t->mean = body;
  t->dim = dim;
  for (int i = 0; i < dim * dim; ++i) t->F[i] = t->Q[i] = Scalar(0);
  for (int i = 0; i < dim; ++i) t->F[i * dim + i] = Scalar(1);
}

void set_block(Scalar* matrix, int dim, int row, int column, const Mat3& value) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) matrix[(row + i) * dim + column + j] = value(i, j);
}

}  // namespace

void predict_constant_velocity(const Body& body, const BodyLayout& layout, Scalar dt, const MotionNoise& noise,
                               Transition* transition) {
  const Vec3 rotation = body.w_C * dt;
  const Mat3 J = body.q_WC.toRotationMatrix().lazyProduct(left_jacobian_so3(rotation));
  clear(transition, body, layout);
  const int dim = transition->dim, velocity = layout.row(BodyPart::kVelocity);
  const int rate = layout.row(BodyPart::kAngularVelocity);
  Body& mean = transition->mean;
  mean.q_WC = body.q_WC * exp_so3(rotation);
  mean.q_WC.normalize();
  mean.p_W += body.v_W * dt;
  const Mat3 I = Mat3::Identity();
  set_block(transition->F, dim, Body::kTheta, rate, dt * J);
  set_block(transition->F, dim, Body::kPosition, velocity, dt * I);

  const Scalar a = noise.linear * noise.linear;
  const Scalar b = noise.angular * noise.angular;
  const Scalar d1 = dt, d2 = dt * dt / Scalar(2), d3 = dt * dt * dt / Scalar(3);
  set_block(transition->Q, dim, Body::kPosition, Body::kPosition, a * d3 * I);
  set_block(transition->Q, dim, Body::kPosition, velocity, a * d2 * I);
  set_block(transition->Q, dim, velocity, Body::kPosition, a * d2 * I);
  set_block(transition->Q, dim, velocity, velocity, a * d1 * I);
  const Mat3 Jt = J.transpose();
  set_block(transition->Q, dim, Body::kTheta, Body::kTheta, b * d3 * J.lazyProduct(Jt));
  set_block(transition->Q, dim, Body::kTheta, rate, b * d2 * J);
  set_block(transition->Q, dim, rate, Body::kTheta, b * d2 * Jt);
  set_block(transition->Q, dim, rate, rate, b * d1 * I);
}

void predict_constant_acceleration(const Body& body, const BodyLayout& layout, Scalar dt, const MotionNoise& noise,
                                   Transition* transition) {
  const Vec3 turn = body.w_C * dt;
  const TurnIntegral S = turn_integral(turn), T = turn_integral_of_ramp(turn);
  const Mat3 R = body.q_WC.toRotationMatrix(), J = R.lazyProduct(S.matrix()), RT = R.lazyProduct(T.matrix());
  const Mat3 Rt = R.transpose(), by_v = dt * J.lazyProduct(Rt), of_v = hat(body.v_W);
  const Vec3 v_C = Rt * body.v_W, half = body.a_C * (dt * dt / Scalar(2));
  clear(transition, body, layout);
  const int dim = transition->dim, velocity = layout.row(BodyPart::kVelocity);
  const int rate = layout.row(BodyPart::kAngularVelocity), acceleration = layout.row(BodyPart::kAcceleration);
  Body& mean = transition->mean;
  mean.q_WC = body.q_WC * exp_so3(turn);
  mean.q_WC.normalize();
  const Mat3 R_after = mean.q_WC.toRotationMatrix();
  const Vec3 way = dt * (J * v_C) + RT * half;
  mean.p_W += way;
  mean.v_W = R_after * (v_C + dt * body.a_C);

  const Mat3 E = R_after.lazyProduct(Rt), turned = -hat(mean.v_W);
  Scalar* const F = transition->F;
  set_block(F, dim, Body::kTheta, rate, dt * J);
  set_block(F, dim, Body::kPosition, Body::kTheta, by_v.lazyProduct(of_v) - hat(way));
  set_block(F, dim, Body::kPosition, velocity, by_v);
  set_block(F, dim, Body::kPosition, rate, R.lazyProduct(Mat3(dt * (dt * S.by_phi(v_C) + T.by_phi(half)))));
  set_block(F, dim, Body::kPosition, acceleration, dt * dt / Scalar(2) * RT);
  set_block(F, dim, velocity, Body::kTheta, E.lazyProduct(of_v) + turned);
  set_block(F, dim, velocity, velocity, E);
  set_block(F, dim, velocity, rate, dt * turned.lazyProduct(J));
  set_block(F, dim, velocity, acceleration, dt * R_after);

  // Of white noise that is integrated once, twice and three times, and of their products.
  const Scalar a = noise.linear * noise.linear, b = noise.angular * noise.angular;
  const Scalar d1 = dt, d2 = dt * dt / Scalar(2), d3 = dt * dt * dt / Scalar(3);
  const Scalar d4 = d2 * d2 / Scalar(2), third = dt * d2 / Scalar(3), d5 = kThrice * dt * dt * dt * dt * dt;
  const Mat3 I = Mat3::Identity();
  Scalar* const Q = transition->Q;
  const auto set_both = [&](int row, int column, const Mat3& value) {
    set_block(Q, dim, row, column, value);
    set_block(Q, dim, column, row, value.transpose());
  };
  const Mat3 of_turn = b * d3 * J.lazyProduct(J.transpose()), by_turn = turned.lazyProduct(of_turn);
  set_block(Q, dim, Body::kTheta, Body::kTheta, of_turn);
  set_both(Body::kTheta, rate, b * d2 * J);
  set_block(Q, dim, rate, rate, b * d1 * I);
  set_both(velocity, Body::kTheta, by_turn);
  set_both(velocity, rate, b * d2 * turned.lazyProduct(J));
  const Mat3 of_velocity = by_turn.lazyProduct(turned.transpose());
  set_block(Q, dim, velocity, velocity, a * d3 * I + (of_velocity + of_velocity.transpose()) / Scalar(2));
  set_block(Q, dim, Body::kPosition, Body::kPosition, a * d5 * I);
  set_both(Body::kPosition, velocity, a * d4 * I);
  set_both(Body::kPosition, acceleration, a * third * R_after);
  set_both(velocity, acceleration, a * d2 * R_after);
  set_block(Q, dim, acceleration, acceleration, a * d1 * I);
}

void damp_acceleration(const Body& body, const BodyLayout& layout, Scalar factor, Scalar sigma,
                       Transition* transition) {
  clear(transition, body, layout);
  const int dim = transition->dim, first = layout.row(BodyPart::kAcceleration);
  for (int i = first; i < first + 3; ++i) {
    transition->F[i * dim + i] = factor;
    transition->Q[i * dim + i] = (Scalar(1) - factor * factor) * sigma * sigma;
  }
  transition->mean.a_C *= factor;
}

void change_velocity(const Body& body, const BodyLayout& layout, const Vec3& dv_C, const Vec3& dw_C,
                     Transition* transition) {
  clear(transition, body, layout);
  const Vec3 dv_W = body.q_WC * dv_C;
  transition->mean.v_W += dv_W;
  transition->mean.w_C += dw_C;
  set_block(transition->F, transition->dim, layout.row(BodyPart::kVelocity), Body::kTheta, -hat(dv_W));
}

void damp_speed(const Body& body, const BodyLayout& layout, Scalar factor, const Vec3& rate, const Mat6& P_m,
                Transition* transition) {
  const int dim = layout.dynamic_rows(), first = layout.row(BodyPart::kVelocity);  // the angular velocity follows
  clear(transition, body, layout);
  Vec6 m;
  m << body.v_W, rate;
  for (int i = 0; i < 6; ++i) {
    transition->F[(first + i) * dim + first + i] = factor;
    for (int j = 0; j < 6; ++j)
      transition->Q[(first + i) * dim + first + j] = (Scalar(1) - factor * factor) * (P_m(i, j) + m(i) * m(j));
  }
  transition->mean.v_W *= factor;
  transition->mean.w_C *= factor;
}

void predict_constant_position(const Body& body, const BodyLayout& layout, Scalar dt, const MotionNoise& noise,
                               Transition* transition) {
  clear(transition, body, layout);
  const int dim = transition->dim;
  const Mat3 I = Mat3::Identity();
  set_block(transition->Q, dim, Body::kTheta, Body::kTheta, noise.angular * noise.angular * dt * I);
  set_block(transition->Q, dim, Body::kPosition, Body::kPosition, noise.linear * noise.linear * dt * I);
}

}  // namespace pf
