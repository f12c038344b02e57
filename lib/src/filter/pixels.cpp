#include <algorithm>

#include "filter/filter.h"
#include "filter/model/kinds.h"
#include "filter/observe/inverse_depth.h"
#include "filter/observe/point.h"
#include "filter/observe/row.h"

/// Pixels: what is expected of them, each at the pose of its own row (lib/docs/rolling_shutter.md).

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

/// A pixel from the body of a row: Jacobians by the speeds too, and the row's own dependence on the pixel.
///
///   dz = H_row dx + z' k dz_y      k seconds per pixel, z' what the row's motion does to the pixel [px/s]
PixelMeasurement with_speeds(const PixelMeasurement& at_row, const BodyLayout& layout, const RowBody& row, Scalar k) {
  const int velocity = layout.row(BodyPart::kVelocity), rate = layout.row(BodyPart::kAngularVelocity);
  const int columns = at_row.H.columns(), wide = columns + 6;
  PixelMeasurement o = at_row;
  o.H.part[0].size = 12;
  Mat2 M = Mat2::Identity();
  Vec2 drift;
  for (int a = 0; a < 2; ++a) {
    const Scalar* from = at_row.H.h + a * columns;
    Scalar* to = o.H.h + a * wide;
    const Vec3 J_theta(from[0], from[1], from[2]), J_p(from[3], from[4], from[5]);
    const Vec3 J_w = row.J_theta_w.transpose().lazyProduct(J_theta), J_v = row.tau * J_p;
    for (int c = 0; c < 6; ++c) to[c] = from[c];
    for (int c = 0; c < 3; ++c) {
      to[velocity + c] = J_v(c);
      to[rate + c] = J_w(c);
    }
    for (int c = 6; c < columns; ++c) to[c + 6] = from[c];
    drift(a) = J_theta.dot(row.body.q_WC * row.body.w_C) + J_p.dot(row.body.v_W);
  }
  const Scalar own = std::max(Scalar(1) - k * drift.y(), Scalar(0.1));
  M(0, 1) = k * drift.x() / own;
  M(1, 1) = Scalar(1) / own;
  for (int c = 0; c < wide; ++c) {
    const Vec2 h = M * Vec2(o.H.h[c], o.H.h[wide + c]);
    o.H.h[c] = h.x();
    o.H.h[wide + c] = h.y();
  }
  return o;
}

}  // namespace

/// Parallax is the product of inverse depth and baseline. Where both are uncertain, what neither Jacobian shows is their product, with
/// covariance sigma_rho^2 J P_baseline J^T (second-order term; zero first-order Jacobian at a baseline of zero).
Mat2 Filter::parallax_noise(int slot, Scalar rho, const Mat23& J_z_anchor) const {
  if (!(rho > Scalar(1e-6))) return Mat2::Zero();
  const Triangle& P = covariance();
  const int from = first_row(state_.block[slot].parent);
  const Scalar factor = block_variance(slot, 2) / (rho * rho);
  Mat3 baseline;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      baseline(i, j) = P(Body::kPosition + i, Body::kPosition + j) + P(from + i, from + j) -
                       P(Body::kPosition + i, from + j) - P(from + i, Body::kPosition + j);
  const Mat23 JP = J_z_anchor.lazyProduct(baseline);
  return factor * JP.lazyProduct(J_z_anchor.transpose());
}

/// The pixel as a camera at `body` sees it.
bool Filter::predict_at(const Camera& camera, const Body& body, int slot, PixelMeasurement* out) const {
  const Block& block = state_.block[slot];
  Place at;
  Mat26 J_body;
  Mat23 J_o, J_feature;
  if (!find_place(state_, slot, &at)) return false;
  out->block = slot;
  out->second_order.setZero();
  out->bend = Scalar(0);
  const int columns = Body::kPoseDim + at.columns;
  if (at.w_column < 0) {  // Gee 2007, eq 2, 9 and 10
    if (!observe_point(camera, body, at.o, &out->predicted, &J_body, &J_o)) return false;
    for (int c = 0; c < at.columns; ++c) {
      const Vec2 h = J_o * at.J_o.col(c);
      out->H.h[6 + c] = h.x();
      out->H.h[columns + 6 + c] = h.y();
    }
    if (at.plane >= 0) out->second_order = planar_noise(state_, block, at, J_o, roughness_);
  } else {
    if (!observe_inverse_depth(camera, body, at.o, block.inverse_depth(), &out->predicted, &J_body, &J_o, &J_feature))
      return false;
    put<2, 3>(out->H.h, columns, 6, J_o);
    put<2, 3>(out->H.h, columns, 9, J_feature);
    out->second_order = parallax_noise(slot, at.w, J_o);
  }
  put<2, 6>(out->H.h, columns, 0, J_body);
  out->H.parts = 1 + at.parts;
  out->H.part[0] = Part::body(Body::kTheta, Body::kPoseDim);
  for (int p = 0; p < at.parts; ++p) out->H.part[1 + p] = at.part[p];
  return true;
}

bool Filter::predict_pixel(const Camera& camera, int slot, PixelMeasurement* out) const {
  if (!predict_at(camera, state_.body, slot, out)) return false;
  if (camera.readout == Scalar(0) || !state_.layout.has(BodyPart::kVelocity)) return true;
  // Where the pixel is says when it was read out, which says where it is: the camera moves little in that time.
  RowBody row;
  for (int turn = 0; turn < 2; ++turn) {
    row = body_at_row(state_.body, row_time(camera, out->predicted.y()));
    if (!predict_at(camera, row.body, slot, out)) return false;
  }
  *out = with_speeds(*out, state_.layout, row, camera.readout / static_cast<Scalar>(camera.height));
  return true;
}

Mat2 Filter::innovation(const PixelMeasurement& pixel) const {
  const Triangle& P = covariance();
  int column[SparseRows::kMaxColumns];
  const int c = blocks_.columns(pixel.H, column);
  const Scalar* h0 = pixel.H.h;
  const Scalar* h1 = pixel.H.h + c;
  Scalar s00 = 0, s01 = 0, s11 = 0;
  for (int i = 0; i < c; ++i) {
    Scalar p0 = 0, p1 = 0;  // row i of the lower triangle of P, without its diagonal, times H^T
    for (int j = 0; j < i; ++j) {
      const Scalar p = P(column[i], column[j]);
      p0 += p * h0[j];
      p1 += p * h1[j];
    }
    const Scalar p = P(column[i], column[i]);
    s00 += h0[i] * (p * h0[i] + 2 * p0);
    s01 += h0[i] * (p * h1[i] + p1) + h1[i] * p0;
    s11 += h1[i] * (p * h1[i] + 2 * p1);
  }
  Mat2 S;
  S << s00, s01, s01, s11;
  return S;
}

}  // namespace pf
