#include "filter/filter.h"
#include "geometry/so3.h"

/// A body at rest (lib/docs/theory/inertial.md).

namespace pf {

void Filter::predict_still(const StillReading& still, Scalar gravity, StillMeasurement* out) const {
  constexpr int kGyro = 3, kAccel = 6, kGravity = 9, kTurn = 11;
  const bool turns = state_.layout.has(BodyPart::kMountRotation), scales = state_.layout.has(BodyPart::kIntrinsics);
  const int scale = turns ? kTurn + 3 : kTurn, columns = scales ? scale + Intrinsics::kAccelRows : scale;
  const Body& body = state_.body;
  const Mat3 D_inverse = state_.mounting.intrinsics.D_a.inverse();
  const Mat3 R_BW = D_inverse * (body.q_WC.toRotationMatrix() * state_.mounting.R_CB).transpose();
  const Mat3 R_WG = body.q_WG.toRotationMatrix();
  const Vec3 g_W = gravity * R_WG.col(2);
  Mat32 E;
  E << -gravity * R_WG.col(1), gravity * R_WG.col(0);
  std::fill(out->H.h, out->H.h + StillMeasurement::kHeight * columns, Scalar(0));
  Scalar* const of_accel = out->H.h + 3 * columns;
  put<3, 3>(out->H.h, columns, kGyro, Mat3::Identity());
  put<3, 3>(of_accel, columns, 0, Mat3(-R_BW * hat(g_W)));
  put<3, 3>(of_accel, columns, kAccel, Mat3::Identity());
  put<3, 2>(of_accel, columns, kGravity, Mat32(-R_BW * E));
  out->H.parts = 2;
  out->H.part[0] = Part::body(Body::kTheta, 3);
  out->H.part[1] = Part::body(state_.layout.row(BodyPart::kGyroBias), 8);
  if (turns) {
    put<3, 3>(of_accel, columns, kTurn, Mat3(-R_BW * hat(g_W) * body.q_WC.toRotationMatrix()));
    out->H.part[out->H.parts++] = Part::body(state_.layout.row(BodyPart::kMountRotation), 3);
  }
  if (scales) {
    put<3, Intrinsics::kAccelRows>(
        of_accel, columns, scale,
        Eigen::Matrix<Scalar, 3, Intrinsics::kAccelRows>(D_inverse * Intrinsics::accel_by_errors(R_BW * g_W)));
    out->H.part[out->H.parts++] =
        Part::body(state_.layout.row(BodyPart::kIntrinsics) + Intrinsics::kGyroRows, Intrinsics::kAccelRows);
  }
  out->predicted << body.gyro_bias, body.accel_bias - R_BW * g_W;
  out->measured << still.gyro, still.accel;
  StillMeasurement::Matrix R = StillMeasurement::Matrix::Zero();
  for (int i = 0; i < 3; ++i) {
    R(i, i) = still.sigma_gyro * still.sigma_gyro;
    R(3 + i, 3 + i) = still.sigma_accel * still.sigma_accel;
  }
  out->set_noise(R);
}

Scalar Filter::unit_turn_variance() const {
  if (!state_.layout.has(BodyPart::kMountRotation)) return Scalar(0);
  const int first = state_.layout.row(BodyPart::kMountRotation);
  return (variance(first) + variance(first + 1) + variance(first + 2)) / Scalar(3);
}

bool Filter::take_still(const StillReading& still, Scalar gravity, Scalar max_nis, bool commit) {
  StillMeasurement rows;
  predict_still(still, gravity, &rows);
  const Measurement view = rows.view();
  Scalar nis = 0;
  begin_update(&view, 1);
  if (!solve_update(&view, 1, nullptr, &nis) || nis > max_nis) return false;
  if (commit) commit_update();
  return true;
}

}  // namespace pf
