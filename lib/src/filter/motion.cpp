#include "filter/motion.h"

#include "geometry/so3.h"

namespace pf {
namespace {

void clear(Transition* t, const Body& body, int dim) {
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

void predict_constant_velocity(const Body& body, Scalar dt, const MotionNoise& noise, Transition* transition) {
  const Vec3 turn = body.w_C * dt;
  const Mat3 J = body.q_WC.toRotationMatrix().lazyProduct(left_jacobian_so3(turn));
  constexpr int kDim = Body::kMaxDim;
  clear(transition, body, kDim);
  Body& mean = transition->mean;
  mean.q_WC = body.q_WC * exp_so3(turn);
  mean.q_WC.normalize();
  mean.p_W += body.v_W * dt;
  const Mat3 I = Mat3::Identity();
  set_block(transition->F, kDim, Body::kTheta, Body::kRate, dt * J);
  set_block(transition->F, kDim, Body::kPosition, Body::kVelocity, dt * I);

  const Scalar a = noise.linear * noise.linear;
  const Scalar b = noise.angular * noise.angular;
  const Scalar d1 = dt, d2 = dt * dt / Scalar(2), d3 = dt * dt * dt / Scalar(3);
  set_block(transition->Q, kDim, Body::kPosition, Body::kPosition, a * d3 * I);
  set_block(transition->Q, kDim, Body::kPosition, Body::kVelocity, a * d2 * I);
  set_block(transition->Q, kDim, Body::kVelocity, Body::kPosition, a * d2 * I);
  set_block(transition->Q, kDim, Body::kVelocity, Body::kVelocity, a * d1 * I);
  const Mat3 Jt = J.transpose();
  set_block(transition->Q, kDim, Body::kTheta, Body::kTheta, b * d3 * J.lazyProduct(Jt));
  set_block(transition->Q, kDim, Body::kTheta, Body::kRate, b * d2 * J);
  set_block(transition->Q, kDim, Body::kRate, Body::kTheta, b * d2 * Jt);
  set_block(transition->Q, kDim, Body::kRate, Body::kRate, b * d1 * I);
}

void change_velocity(const Body& body, const Vec3& dv_C, const Vec3& dw_C, Transition* transition) {
  constexpr int kDim = Body::kMaxDim;
  clear(transition, body, kDim);
  const Vec3 dv_W = body.q_WC * dv_C;
  transition->mean.v_W += dv_W;
  transition->mean.w_C += dw_C;
  set_block(transition->F, kDim, Body::kVelocity, Body::kTheta, -hat(dv_W));
}

void damp_speed(const Body& body, Scalar factor, const Mat6& P_m, Transition* transition) {
  constexpr int kDim = Body::kMaxDim, kSpeed = Body::kVelocity;
  clear(transition, body, kDim);
  Vec6 m;
  m << body.v_W, body.w_C;
  for (int i = 0; i < 6; ++i) {
    transition->F[(kSpeed + i) * kDim + kSpeed + i] = factor;
    for (int j = 0; j < 6; ++j)
      transition->Q[(kSpeed + i) * kDim + kSpeed + j] = (Scalar(1) - factor * factor) * (P_m(i, j) + m(i) * m(j));
  }
  transition->mean.v_W *= factor;
  transition->mean.w_C *= factor;
}

void predict_constant_position(const Body& body, Scalar dt, const MotionNoise& noise, Transition* transition) {
  constexpr int kDim = Body::kPoseDim;
  clear(transition, body, kDim);
  const Mat3 I = Mat3::Identity();
  set_block(transition->Q, kDim, Body::kTheta, Body::kTheta, noise.angular * noise.angular * dt * I);
  set_block(transition->Q, kDim, Body::kPosition, Body::kPosition, noise.linear * noise.linear * dt * I);
}

}  // namespace pf
