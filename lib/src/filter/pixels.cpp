#include <algorithm>

#include "filter/filter.h"
#include "filter/observe/point.h"
#include "filter/observe/row.h"
#include "filter/observe/world_point.h"

/// Pixels: what is expected of them, each at the pose of its own row (lib/docs/rolling_shutter.md).

namespace pf {
namespace {

/// What a planar feature's pixel owes to the roughness of its surface and to coordinates that have no rows.
Mat2 planar_noise(const State& state, const Block& block, const Mat23& J_z_p, const Mat32& J_p_c, Scalar roughness) {
  const Block* plane = &state.block[block.parent];
  if (plane->kind == BlockKind::kPatch) plane = &state.block[plane->parent];
  const Vec2 rough = roughness * (J_z_p * state.frame_of(*plane).R_WP.col(2));
  Mat2 noise = rough * rough.transpose();
  if (block.kind == BlockKind::kPatchPoint && block.size == 0) {
    const Mat2 J = J_z_p * J_p_c;
    noise += J * block.inside() * J.transpose();
  }
  return noise;
}

/// A pixel from the body of a row: Jacobians by the speeds too, and the row's own dependence on the pixel.
///
///   dz = H_row dx + z' k dz_y      k seconds per pixel, z' what the row's motion does to the pixel [px/s]
PixelMeasurement with_speeds(const PixelMeasurement& at_row, const RowBody& row, Scalar k) {
  const int columns = at_row.H.columns(), wide = columns + Body::kMaxDim - Body::kPoseDim;
  PixelMeasurement o = at_row;
  o.H.part[0].size = Body::kMaxDim;
  Mat2 M = Mat2::Identity();
  Vec2 drift;
  for (int a = 0; a < 2; ++a) {
    const Scalar* from = at_row.H.h + a * columns;
    Scalar* to = o.H.h + a * wide;
    const Vec3 J_theta(from[0], from[1], from[2]), J_p(from[3], from[4], from[5]);
    const Vec3 J_w = row.J_theta_w.transpose().lazyProduct(J_theta), J_v = row.tau * J_p;
    for (int c = 0; c < 6; ++c) to[c] = from[c];
    for (int c = 0; c < 3; ++c) {
      to[Body::kVelocity + c] = J_v(c);
      to[Body::kRate + c] = J_w(c);
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

/// The pixel as a camera at `body` sees it.
bool Filter::predict_at(const Camera& camera, const Body& body, int slot, PixelMeasurement* out) const {
  const Block& block = state_.block[slot];
  Mat26 J_body;
  Mat23 J_anchor, J_feature;
  out->block = slot;
  out->second_order.setZero();
  out->bend = Scalar(0);
  out->H.part[0] = Part::body(Body::kTheta, Body::kPoseDim);
  if (block.kind == BlockKind::kPoint) {
    if (!observe_point(camera, body, block.xyz(), &out->predicted, &J_body, &J_feature)) return false;
    out->H.parts = 2;
    out->H.part[1] = Part::of(slot, 0, 3);
    put<2, 6>(out->H.h, 9, 0, J_body);
    put<2, 3>(out->H.h, 9, 6, J_feature);
    return true;
  }
  if (is_planar(block.kind)) {  // Gee 2007, eq 9 and 10
    WorldPoint at;
    Mat32 J_p_c = Mat32::Zero();
    world_point(state_, slot, &at, &J_p_c);
    if (!observe_point(camera, body, at.p_W, &out->predicted, &J_body, &J_feature)) return false;
    const int columns = 6 + at.columns;
    out->H.parts = 1 + at.parts;
    for (int p = 0; p < at.parts; ++p) out->H.part[1 + p] = at.part[p];
    put<2, 6>(out->H.h, columns, 0, J_body);
    for (int c = 0; c < at.columns; ++c) {
      const Vec2 h = J_feature * at.J.col(c);
      out->H.h[6 + c] = h.x();
      out->H.h[columns + 6 + c] = h.y();
    }
    out->second_order = planar_noise(state_, block, J_feature, J_p_c, roughness_);
    return true;
  }
  if (block.kind == BlockKind::kInverseDepth) {
    const Block& anchor = state_.block[block.parent];
    if (!observe_inverse_depth(camera, body, anchor.xyz(), block.inverse_depth(), &out->predicted, &J_body, &J_anchor,
                               &J_feature))
      return false;
    out->H.parts = 3;
    out->H.part[1] = Part::of(block.parent, 0, 3);
    out->H.part[2] = Part::of(slot, 0, 3);
    put<2, 6>(out->H.h, 12, 0, J_body);
    put<2, 3>(out->H.h, 12, 6, J_anchor);
    put<2, 3>(out->H.h, 12, 9, J_feature);
    // Parallax is the product of inverse depth and baseline. Where both are uncertain, what neither Jacobian shows is their
    // product, with covariance sigma_rho^2 J P_baseline J^T (second-order term; zero first-order Jacobian at a baseline of zero).
    const Scalar rho = block.inverse_depth().rho;
    if (rho > Scalar(1e-6)) {
      const Triangle& P = covariance();
      const int from = first_row(block.parent);
      const Scalar factor = block_variance(slot, 2) / (rho * rho);
      Mat3 baseline;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          baseline(i, j) = P(Body::kPosition + i, Body::kPosition + j) + P(from + i, from + j) -
                           P(Body::kPosition + i, from + j) - P(from + i, Body::kPosition + j);
      const Mat23 JP = J_anchor.lazyProduct(baseline);
      out->second_order = factor * JP.lazyProduct(J_anchor.transpose());
    }
    return true;
  }
  return false;
}

bool Filter::predict_pixel(const Camera& camera, int slot, PixelMeasurement* out) const {
  if (!predict_at(camera, state_.body, slot, out)) return false;
  if (camera.readout == Scalar(0) || state_.body_dim != Body::kMaxDim) return true;
  // Where the pixel is says when it was read out, which says where it is: the camera moves little in that time.
  RowBody row;
  for (int turn = 0; turn < 2; ++turn) {
    row = body_at_row(state_.body, row_time(camera, out->predicted.y()));
    if (!predict_at(camera, row.body, slot, out)) return false;
  }
  *out = with_speeds(*out, row, camera.readout / static_cast<Scalar>(camera.height));
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
