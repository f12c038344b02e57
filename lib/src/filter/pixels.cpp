#include "filter/filter.h"
#include "filter/row_follow.h"
#include "model/kinds.h"
#include "model/tuning.h"
#include "observe/inverse_depth.h"
#include "observe/point.h"

/// Pixels: what is expected of them, each at the pose of its own row (lib/docs/theory/rolling_shutter.md).

namespace pf {
namespace {

/// What a planar feature's pixel owes to the roughness of its surface and to coordinates that have no rows.
Mat2 planar_noise(const State& state, const Block& block, const Place& at, const Mat23& J_z_p, Scalar roughness) {
  const Vec2 rough = roughness * (J_z_p * state.frame_of(state.block[at.plane]).R_WP.col(2));
  Mat2 noise = rough * rough.transpose();
  if (!at.has_rows) {
    const Mat2 J = J_z_p * at.J_own;
    noise += J * block.inside() * J.transpose();
  }
  return noise;
}

/// Extends the pixel's Jacobian by the dependence of its row's time on the pixel.
void follow_row(const CameraAt& camera, const Mat26& J_camera, Scalar k, PixelMeasurement* out) {
  const Mat2 M = row_follow(camera, J_camera, k);
  const int columns = out->H.columns();
  for (int c = 0; c < columns; ++c) {
    const Vec2 h = M * Vec2(out->H.h[c], out->H.h[columns + c]);
    out->H.h[c] = h.x();
    out->H.h[columns + c] = h.y();
  }
}

/// What the unknown rotation of an inertial unit does to a row that is read out early or late: w = R_CB (gyro - bias), e_w = -[w]x mu, and
/// -R_CB e_b = e_w. It is the same for all rows, but far below their noise once the camera has moved, so it has no columns of its own.
Mat2 mounting_noise(const State& state, const CameraAt& camera, const Mat26& J_camera, const Triangle& P) {
  const int first = state.layout.row(BodyPart::kMountRotation);
  const Mat23 by_bias =
      J_camera.leftCols<3>().lazyProduct(camera.J_theta_w) + J_camera.rightCols<3>().lazyProduct(camera.J_p_w);
  const Mat23 J = by_bias * (state.mounting.rate_by_reading().inverse() * hat(camera.w_C));
  Mat3 C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) C(i, j) = P(first + (i > j ? i : j), first + (i > j ? j : i));
  return J * C * J.transpose();
}

}  // namespace

/// Parallax is the product of inverse depth and baseline. Where both are uncertain, what neither Jacobian shows is their product, with
/// covariance sigma_rho^2 J P_baseline J^T (second-order term; zero first-order Jacobian at a baseline of zero). Of a rolling shutter's row
/// the baseline ends at p + v tau.
Mat2 Filter::parallax_noise(const CameraAt& camera, int slot, Scalar rho, const Mat23& J_z_anchor) const {
  if (!(rho > tuning::inverse_depth::kMinRho)) return Mat2::Zero();
  const Triangle& P = covariance();
  const int from = first_row(state_.block[slot].parent);
  const Scalar factor = block_variance(slot, 2) / (rho * rho);
  Mat3 baseline;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      baseline(i, j) = P(Body::kPosition + i, Body::kPosition + j) + P(from + i, from + j) -
                       P(Body::kPosition + i, from + j) - P(from + i, Body::kPosition + j);
  if (camera.tau != Scalar(0)) {
    const int v = camera.velocity_row;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        baseline(i, j) += camera.tau * (P(v + i, Body::kPosition + j) + P(v + j, Body::kPosition + i) -
                                        P(from + i, v + j) - P(from + j, v + i)) +
                          camera.tau * camera.tau * P(v + i, v + j);
  }
  const Mat23 JP = J_z_anchor.lazyProduct(baseline);
  return factor * JP.lazyProduct(J_z_anchor.transpose());
}

/// The pixel as a camera sees it that is read out at once. J_camera is by its (theta, p).
bool Filter::predict_at(const Camera& lens, const CameraAt& camera, int slot, PixelMeasurement* out,
                        Mat26* J_camera) const {
  const Block& block = state_.block[slot];
  Place at;
  Mat23 J_o, J_feature;
  if (!find_place(state_, slot, &at)) return false;
  out->block = slot;
  out->second_order.setZero();
  out->bend = Scalar(0);
  const int lens_rows = state_.lens_rows.count, first = camera.columns() + lens_rows, columns = first + at.columns;
  if (at.w_column < 0) {  // Gee 2007, eq 2, 9 and 10
    if (!observe_point(lens, camera, at.o, &out->predicted, J_camera, &J_o)) return false;
    for (int c = 0; c < at.columns; ++c) {
      const Vec2 h = J_o * at.J_o.col(c);
      out->H.h[first + c] = h.x();
      out->H.h[columns + first + c] = h.y();
    }
    if (at.plane >= 0)
      out->second_order = planar_noise(state_, block, at, J_o, state_.roughness_of(state_.block[at.plane]));
  } else {
    if (!observe_inverse_depth(lens, camera, at.o, block.inverse_depth(), &out->predicted, J_camera, &J_o, &J_feature))
      return false;
    put<2, 3>(out->H.h, columns, first, J_o);
    put<2, 3>(out->H.h, columns, first + 3, J_feature);
    out->second_order = parallax_noise(camera, slot, at.w, J_o);
  }
  camera.chain(*J_camera, out->H.h, columns);
  out->H.parts = 0;
  out->H.part[out->H.parts++] = camera.part();
  if (lens_rows > 0) {
    const Vec3 d_W = at.w * (at.o - camera.p_W) + at.b;
    LensJacobian J_lens = lens_jacobian(lens, camera.q_WC.conjugate() * d_W);
    J_lens.col(kReadoutParameter) = camera.by_readout<2>(*J_camera, lens.readout);
    put_lens(J_lens, state_.lens_rows, camera.columns(), columns, out->H.h);
    out->H.part[out->H.parts++] = Part::body(state_.layout.row(BodyPart::kLens), lens_rows);
  }
  for (int p = 0; p < at.parts; ++p) out->H.part[out->H.parts++] = at.part[p];
  return true;
}

bool Filter::predict_pixel(const Camera& lens, int slot, PixelMeasurement* out) const {
  Mat26 J_camera;
  if (!predict_at(lens, camera_at(state_, Scalar(0)), slot, out, &J_camera)) return false;
  if (!rows_roll(state_, lens)) return true;
  // The pixel's row gives its time, and its time the pixel: two iterations, since the camera moves little in between.
  CameraAt camera;
  for (int round = 0; round < 2; ++round) {
    camera = camera_of_row(state_, lens, out->predicted.y());
    if (!predict_at(lens, camera, slot, out, &J_camera)) return false;
  }
  if (camera.tau != Scalar(0) && state_.layout.has(BodyPart::kMountRotation))
    out->second_order += mounting_noise(state_, camera, J_camera, covariance());
  follow_row(camera, J_camera, lens.readout / static_cast<Scalar>(lens.height), out);
  return true;
}

}  // namespace pf
