#include "model/camera_at.h"

#include <algorithm>

#include "geometry/so3.h"

namespace pf {

CameraAt camera_at(const Body& body) {
  CameraAt camera;
  camera.q_WC = body.q_WC;
  camera.p_W = body.p_W;
  camera.v_W = body.v_W;
  camera.w_C = body.w_C;
  return camera;
}

Vec3 camera_velocity(const Body& body, const Mounting& mounting) {
  return body.v_W - body.q_WC * body.w_C.cross(mounting.p_C);
}

void put_unit(const State& state, CameraAt* camera) {
  const Body& body = state.body;
  const Mounting& mounting = state.mounting;
  const Mat3 R = body.q_WC.toRotationMatrix();
  camera->beside = true;
  const Mat3 J_theta_w = camera->J_theta_w;
  camera->J_theta_w = -J_theta_w.lazyProduct(mounting.rate_by_reading());
  const Vec3 bend_W = R * (camera->tau * camera->tau / 2 * state.bend.a_C);
  camera->p_W += bend_W;
  camera->J_p_theta = camera->tau * hat(body.v_W - camera->v_W) - hat(bend_W);
  camera->J_p_w = -camera->tau * R.lazyProduct(hat(mounting.p_C)).lazyProduct(mounting.rate_by_reading());
  camera->v_W += camera->tau * (R * state.bend.a_C);
  camera->w_C += camera->tau * state.bend.alpha_C;
}

CameraAt camera_at(const State& state, Scalar tau) {
  const Body& body = state.body;
  CameraAt camera = camera_at(body);
  const bool has_unit = state.layout.has(BodyPart::kGyroBias);
  if (has_unit) camera.v_W = camera_velocity(body, state.mounting);
  if (tau == Scalar(0) || !state.layout.has(BodyPart::kVelocity)) return camera;
  camera.tau = tau;
  camera.velocity_row = state.layout.row(BodyPart::kVelocity);
  camera.rate_row = state.layout.row(has_unit ? BodyPart::kGyroBias : BodyPart::kAngularVelocity);
  Vec3 rotation = body.w_C * tau;
  if (has_unit) rotation += tau * tau / 2 * state.bend.alpha_C;
  camera.q_WC = body.q_WC * exp_so3(rotation);
  camera.q_WC.normalize();
  camera.p_W = body.p_W + camera.v_W * tau;
  camera.J_theta_w = tau * body.q_WC.toRotationMatrix().lazyProduct(left_jacobian_so3(rotation));
  if (has_unit) put_unit(state, &camera);
  return camera;
}

Scalar row_time(const Camera& camera, Scalar y) {
  const Scalar part = (y + Scalar(0.5)) / static_cast<Scalar>(camera.height) - Scalar(0.5);
  return camera.readout * std::clamp(part, Scalar(-1), Scalar(1));
}

}  // namespace pf
