#pragma once

#include <algorithm>

#include "filter/state.h"
#include "geometry/camera.h"
#include "geometry/so3.h"

namespace pf {

/// When a row is read out, from the frame's time, which is that of the middle of the image [s]. What lies far outside of the image
/// is taken to be just outside of it.
inline Scalar row_time(const Camera& camera, Scalar y) {
  const Scalar part = (y + Scalar(0.5)) / static_cast<Scalar>(camera.height) - Scalar(0.5);
  return camera.readout * std::clamp(part, Scalar(-1), Scalar(1));
}

/// The camera tau seconds from the frame's time.
///
///   R_tau = R Exp(w tau),  p_tau = p + v tau
///   theta_tau = theta + R J_l(w tau) tau e_w,  e_p_tau = e_p + tau e_v
struct RowBody {
  Scalar tau = 0;
  Body body;
  Mat3 J_theta_w;  ///< R J_l(w tau) tau
};

inline RowBody body_at_row(const Body& body, Scalar tau) {
  RowBody row;
  row.tau = tau;
  row.body = body;
  const Vec3 turn = body.w_C * tau;
  row.body.q_WC = body.q_WC * exp_so3(turn);
  row.body.q_WC.normalize();
  row.body.p_W = body.p_W + body.v_W * tau;
  row.J_theta_w = tau * body.q_WC.toRotationMatrix().lazyProduct(left_jacobian_so3(turn));
  return row;
}

}  // namespace pf
