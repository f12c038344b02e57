#include "keyframe_slam/inertial/map_ruler.h"

#include <algorithm>

#include "geometry/so3.h"
#include "model/camera_at.h"

namespace pf {

bool MapRuler::begin(const Vec3& at, Scalar length, Scalar share) {
  z_o_ = at;
  length_ = length;
  place_slot_ = filter_.add_anchor();
  if (place_slot_ < 0) return false;
  length_slot_ =
      filter_.add_inverse_depth(place_slot_, Vec3::UnitZ(), Mat32::Zero(), Mat2::Zero(), 1 / length, share / length);
  return length_slot_ >= 0;
}

bool MapRuler::is_sound() const {
  const auto is = [&](int slot, BlockKind kind) {
    return slot >= 0 && slot < filter_.state().slots && filter_.state().block[slot].kind == kind;
  };
  return is(place_slot_, BlockKind::kAnchor) && is(length_slot_, BlockKind::kInverseDepth) && rho() > Scalar(0) &&
         length_ > Scalar(0);
}

Scalar MapRuler::scale_variance() const {
  const Scalar of_rho = filter_.block_variance(length_slot_, 2);
  return std::max(Scalar(0), of_rho) / (rho() * rho());
}

Similarity MapRuler::to_filter() const {
  Similarity T;
  T.s = scale();
  T.t = place() - T.s * z_o_;
  return T;
}

Body MapRuler::body() const {
  Body body = filter_.state().body;
  const Scalar s = scale();
  if (filter_.is_metric()) body.v_W = camera_velocity(body, filter_.state().mounting);
  body.p_W = z_o_ + (body.p_W - place()) / s;
  body.v_W /= s;
  return body;
}

void MapRuler::set_rows(const Mat3& rate_by_bias, MotionRows* out) const {
  constexpr int kColumns = 16, kPlace = 12, kLength = 15;
  const Body now = body();
  const Scalar s = scale();
  const Vec3 z = now.p_W - z_o_;
  out->parts = 4;
  out->part[0] = Part::body(Body::kTheta, 9);
  out->part[1] = Part::body(filter_.state().layout.row(BodyPart::kGyroBias), 3);
  out->part[2] = Part::of(place_slot_, 0, 3);
  out->part[3] = Part::of(length_slot_, 2, 1);
  std::fill(out->h, out->h + 12 * kColumns, Scalar(0));
  const Mat3 one = Mat3::Identity(), per_map = one / s;
  put<3, 3>(out->h, kColumns, 0, one);
  put<3, 3>(out->h + 3 * kColumns, kColumns, 3, per_map);
  put<3, 3>(out->h + 3 * kColumns, kColumns, kPlace, Mat3(-per_map));
  put<3, 1>(out->h + 3 * kColumns, kColumns, kLength, Vec3(z / rho()));
  put<3, 3>(out->h + 6 * kColumns, kColumns, 6, per_map);
  put<3, 1>(out->h + 6 * kColumns, kColumns, kLength, Vec3(now.v_W / rho()));
  put<3, 3>(out->h + 9 * kColumns, kColumns, 9, Mat3(-rate_by_bias));
}

void MapRuler::set_measurement(const Quat& q_WC, const Vec3& z, const Mat6& R, PoseMeasurement* out) const {
  MotionRows rows;
  set_rows(Mat3::Zero(), &rows);
  out->H.parts = rows.parts;
  std::copy(rows.part, rows.part + rows.parts, out->H.part);
  std::copy(rows.h, rows.h + 6 * 16, out->H.h);
  const Body now = body();
  out->predicted << Vec3::Zero(), now.p_W;
  out->measured << log_so3(q_WC * now.q_WC.conjugate()), z;
  out->set_noise(R);
}

void MapRuler::rotate_body(const Quat& q, bool with_gravity) {
  Body body = filter_.state().body;
  body.q_WC = (q * body.q_WC).normalized();
  body.v_W = q * body.v_W;
  body.p_W = place() + q * (body.p_W - place());
  if (with_gravity) body.q_WG = (q * body.q_WG).normalized();
  filter_.set_mean(body);
}

void MapRuler::move(const Similarity& T, bool keeps_lengths) {
  rotate_body(T.q, true);
  z_o_ = T.of(z_o_);
  if (keeps_lengths) length_ *= T.s;
}

void MapRuler::move_about(const CameraView& before, const CameraView& now) {
  const Quat q = now.q_WC * before.q_WC.conjugate();
  rotate_body(q, false);
  z_o_ = now.c_W + q * (z_o_ - before.c_W);
}

/// With the axes E of gravity's two rows, d is moved by E^T theta, o by p and, where lengths of the map become (1 + e) times as long, ln s
/// by -e, with the body and z where they are:   e_rho = rho e,   e_o = s (z - z_o) e
void MapRuler::drift(const Mat6& Q, const Vec3& z, Scalar sigma_scale) {
  const int gravity = filter_.state().layout.row(BodyPart::kGravity);
  const Eigen::Matrix<Scalar, 2, 3> E_t = filter_.state().body.q_WG.toRotationMatrix().leftCols<2>().transpose();
  RowsOf<2, 2, 1> tilt;
  tilt.parts = 1;
  tilt.part[0] = Part::body(gravity, 2);
  put<2, 2>(tilt.h, 2, 0, Mat2::Identity());
  const Mat2 of_tilt = E_t.lazyProduct(Q.topLeftCorner<3, 3>()).lazyProduct(E_t.transpose());
  filter_.add_noise(tilt, of_tilt.data());
  const Scalar s = scale();
  RowsOf<4, 4, 2> moved;
  moved.parts = 2;
  moved.part[0] = Part::of(place_slot_, 0, 3);
  moved.part[1] = Part::of(length_slot_, 2, 1);
  put<4, 4>(moved.h, 4, 0, Eigen::Matrix<Scalar, 4, 4>::Identity());
  const Vec3 lever = s * (z - z_o_);
  for (int i = 0; i < 3; ++i) moved.h[3 * 4 + i] = lever(i);
  moved.h[3 * 4 + 3] = rho();
  Eigen::Matrix<Scalar, 4, 4> of_map = Eigen::Matrix<Scalar, 4, 4>::Zero();
  of_map.topLeftCorner<3, 3>() = s * s * Q.bottomRightCorner<3, 3>();
  of_map(3, 3) = sigma_scale * sigma_scale;
  filter_.add_noise(moved, of_map.data());
}

}  // namespace pf
