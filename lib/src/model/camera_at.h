#pragma once

#include "geometry/camera.h"
#include "model/state.h"

namespace pf {

/// The camera tau seconds from the frame's time: its pose, its velocities, and the Jacobian of its error by the parts of the body.
///
///   R_tau = R Exp(w tau),  p_tau = p + v tau
///   theta_tau = theta + R J_l(w tau) tau e_w,  e_p_tau = e_p + tau e_v
///
/// The Jacobian by the pose is the identity, and that by the velocities is zero at tau = 0; neither is stored or multiplied.
///
/// With an inertial unit w = R_CB (gyro - bias), so that e_w = -R_CB e_b stands in the rows of the bias; and the state's velocity v_B is
/// that of the unit's origin, at m in C (lib/docs/theory/inertial.md):
///
///   v = v_B - R (w x m),   e_v = e_v_B + [R (w x m)]x theta + R [m]x e_w
///
/// Its samples measure accelerations too, whose errors do not matter over half a readout:
///
///   R_tau = R Exp(w tau + alpha tau^2 / 2),   p_tau = p + v tau + R a tau^2 / 2
struct CameraAt {
  static constexpr int kMaxColumns = 12;

  Scalar tau = 0;  ///< 0 also where the body has no velocities
  Quat q_WC = Quat::Identity();
  Vec3 p_W = Vec3::Zero();
  Vec3 v_W = Vec3::Zero();
  Vec3 w_C = Vec3::Zero();             ///< at tau, as v_W
  Mat3 J_theta_w;                      ///< R J_l(w tau) tau, by the rows at rate_row; only where tau is not 0
  bool beside = false;                 ///< the state's velocity is that of another point; the two below only then
  Mat3 J_p_theta, J_p_w;               ///< of p_tau, beside the identity and tau
  int velocity_row = 0, rate_row = 0;  ///< of the velocity; of the angular velocity, or of the bias on which it depends

  /// Rows of the body that its error depends on, from the first one on.
  int columns() const { return tau == Scalar(0) ? Body::kPoseDim : rate_row + 3; }
  Part part() const { return Part::body(0, columns()); }

  /// The column of the readout, of which tau is a part, for a J over (theta, p) of this camera:
  ///
  ///   d(theta_tau, p_tau) = (R_tau w, v) tau / readout d_readout
  template <int kRows>
  Eigen::Matrix<Scalar, kRows, 1> by_readout(const Eigen::Matrix<Scalar, kRows, 6>& J, Scalar readout) const {
    Vec6 rate = Vec6::Zero();
    if (tau != Scalar(0) && readout != Scalar(0)) rate << (q_WC * w_C) * (tau / readout), v_W * (tau / readout);
    return J * rate;
  }

  /// J over (theta, p) of this camera, by its rows of `kRows` values, becomes J over the rows of the body; h is row-major.
  template <int kRows>
  void chain(const Eigen::Matrix<Scalar, kRows, 6>& J, Scalar* h, int stride) const {
    put<kRows, 6>(h, stride, 0, J);
    if (tau == Scalar(0)) return;
    for (int a = 0; a < kRows; ++a) {
      const Vec3 J_theta = J.template block<1, 3>(a, 0).transpose(), J_p = J.template block<1, 3>(a, 3).transpose();
      Vec3 J_w = J_theta_w.transpose().lazyProduct(J_theta);
      const Vec3 J_v = tau * J_p;
      if (beside) {
        J_w += J_p_w.transpose().lazyProduct(J_p);
        const Vec3 more = J_p_theta.transpose().lazyProduct(J_p);
        for (int c = 0; c < 3; ++c) h[a * stride + Body::kTheta + c] += more(c);
      }
      for (int c = 0; c < 3; ++c) {
        h[a * stride + velocity_row + c] = J_v(c);
        h[a * stride + rate_row + c] = J_w(c);
      }
    }
  }
};

/// The camera of the body at the frame's time.
CameraAt camera_at(const Body& body);

/// Velocity of the camera where the body's is that of the inertial unit.
Vec3 camera_velocity(const Body& body, const Mounting& mounting);

/// Fills in what depends on the unit's place and axes, for a camera tau seconds from the frame's time.
void put_unit(const State& state, CameraAt* camera);

/// The camera tau seconds from the frame's time; at the frame's time where the body has no velocities.
CameraAt camera_at(const State& state, Scalar tau);

/// Writes a Jacobian by all parameters of the lens into its rows' columns, from `first` on; h is row-major.
template <int kRows>
inline void put_lens(const Eigen::Matrix<Scalar, kRows, kLensParameters>& J, const LensRows& rows, int first,
                     int stride, Scalar* h) {
  for (int i = 0; i < rows.count; ++i)
    for (int a = 0; a < kRows; ++a) h[a * stride + first + i] = J(a, rows.parameter[i]);
}

/// Time at which a row is read out, from the frame's time, which is that of the middle row [s]. Rows far outside of the image count as just
/// outside of it.
Scalar row_time(const Camera& camera, Scalar y);

/// Whether each row has a camera of its own: rows are read out one after the other, and the state has velocities.
inline bool rows_roll(const State& state, const Camera& lens) {
  return lens.readout != Scalar(0) && state.layout.has(BodyPart::kVelocity);
}

/// The camera at the time when row y is read out.
inline CameraAt camera_of_row(const State& state, const Camera& lens, Scalar y) {
  return camera_at(state, row_time(lens, y));
}

}  // namespace pf
