#include "filter/motion.h"

#include "geometry/so3.h"

namespace pf {
namespace {

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
