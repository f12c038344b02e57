#include <cstring>

#include "filter/filter.h"
#include "filter/observe/point.h"
#include "filter/observe/world_point.h"
#include "filter/put.h"

/// Pixels: what is expected of them, and the update with them.

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

}  // namespace

bool Filter::predict_pixel(const Camera& camera, int slot, Observation* out) const {
  const Block& block = state_.block[slot];
  Mat26 J_body;
  Mat23 J_anchor, J_feature;
  out->slot = slot;
  out->second_order.setZero();
  out->segment[0] = {Body::kTheta, Body::kPoseDim};
  if (block.kind == BlockKind::kPoint) {
    if (!observe_point(camera, state_.body, block.xyz(), &out->predicted, &J_body, &J_feature)) return false;
    out->segments = 2;
    out->segment[1] = {block.first, 3};
    put<2, 6>(out->h, 9, 0, J_body);
    put<2, 3>(out->h, 9, 6, J_feature);
    return true;
  }
  if (is_planar(block.kind)) {  // Gee 2007, eq 9 and 10
    WorldPoint at;
    Mat32 J_p_c = Mat32::Zero();
    world_point(state_, slot, &at, &J_p_c);
    if (!observe_point(camera, state_.body, at.p_W, &out->predicted, &J_body, &J_feature)) return false;
    const int columns = 6 + at.columns;
    out->segments = 1 + at.segments;
    for (int s = 0; s < at.segments; ++s) out->segment[1 + s] = at.segment[s];
    put<2, 6>(out->h, columns, 0, J_body);
    for (int c = 0; c < at.columns; ++c) {
      const Vec2 h = J_feature * at.J.col(c);
      out->h[6 + c] = h.x();
      out->h[columns + 6 + c] = h.y();
    }
    out->second_order = planar_noise(state_, block, J_feature, J_p_c, roughness_);
    return true;
  }
  if (block.kind == BlockKind::kInverseDepth) {
    const Block& anchor = state_.block[block.parent];
    if (!observe_inverse_depth(camera, state_.body, anchor.xyz(), block.inverse_depth(), &out->predicted, &J_body,
                               &J_anchor, &J_feature))
      return false;
    out->segments = 3;
    out->segment[1] = {anchor.first, 3};
    out->segment[2] = {block.first, 3};
    put<2, 6>(out->h, 12, 0, J_body);
    put<2, 3>(out->h, 12, 6, J_anchor);
    put<2, 3>(out->h, 12, 9, J_feature);
    // Parallax is the product of inverse depth and baseline. Where both are uncertain, what neither Jacobian shows is their
    // product, with covariance sigma_rho^2 J P_baseline J^T (second-order term; zero first-order Jacobian at a baseline of zero).
    const Scalar rho = block.inverse_depth().rho;
    if (rho > Scalar(1e-6)) {
      const Scalar factor = P_(block.first + 2, block.first + 2) / (rho * rho);
      Mat3 baseline;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          baseline(i, j) = P_(Body::kPosition + i, Body::kPosition + j) + P_(anchor.first + i, anchor.first + j) -
                           P_(Body::kPosition + i, anchor.first + j) - P_(anchor.first + i, Body::kPosition + j);
      const Mat23 JP = J_anchor.lazyProduct(baseline);
      out->second_order = factor * JP.lazyProduct(J_anchor.transpose());
    }
    return true;
  }
  return false;
}

Mat2 Filter::innovation(const Observation& observation) const {
  int column[Observation::kMaxColumns];
  int c = 0;
  for (int s = 0; s < observation.segments; ++s)
    for (int i = 0; i < observation.segment[s].size; ++i) column[c++] = observation.segment[s].first + i;
  const Scalar* h0 = observation.h;
  const Scalar* h1 = observation.h + c;
  Scalar s00 = 0, s01 = 0, s11 = 0;
  for (int i = 0; i < c; ++i) {
    Scalar p0 = 0, p1 = 0;  // row i of the lower triangle of P, without its diagonal, times H^T
    for (int j = 0; j < i; ++j) {
      const Scalar p = P_(column[i], column[j]);
      p0 += p * h0[j];
      p1 += p * h1[j];
    }
    const Scalar p = P_(column[i], column[i]);
    s00 += h0[i] * (p * h0[i] + 2 * p0);
    s01 += h0[i] * (p * h1[i] + p1) + h1[i] * p0;
    s11 += h1[i] * (p * h1[i] + 2 * p1);
  }
  Mat2 S;
  S << s00, s01, s01, s11;
  return S;
}

void Filter::sparse(const Observation& observation, SparseRows* rows) const {
  rows->rows = 2;
  rows->segments = observation.segments;
  for (int s = 0; s < observation.segments; ++s) rows->segment[s] = observation.segment[s];
  std::memcpy(rows->h, observation.h, sizeof(Scalar) * 2 * static_cast<std::size_t>(rows->columns()));
}

/// H P in W_ and S = H P H^T, a few observations at a time, whose rows fit the stack.
void Filter::begin_update(const Observation* observations, int count) {
  PF_ASSERT(2 * count <= max_rows_);
  SparseRows rows[kMostFolded];
  const auto list = [&](int first) {
    const int size = count - first < kMostFolded ? count - first : kMostFolded;
    for (int j = 0; j < size; ++j) sparse(observations[first + j], &rows[j]);
    return size;
  };
  for (int i = 0; i < count; i += kMostFolded) {
    const int size = list(i);
    kernels_->gather_many(P_, rows, size, W_ + 2 * i * ld_, ld_);
  }
  for (int i = 0; i < count; i += kMostFolded) {
    const int size = count > kMostFolded ? list(i) : count;
    kernels_->project(W_ + 2 * i * ld_, 2 * (count - i), ld_, rows, size, S_ + 2 * i * (lds_ + 1), lds_);
  }
}

Mat2 Filter::innovation_block(int i, int j) const {
  const Scalar* S = S_ + 2 * (i > j ? i : j) * lds_ + 2 * (i > j ? j : i);  // of the lower triangle
  Mat2 block;
  block << S[0], i == j ? S[lds_] : S[1], S[lds_], S[lds_ + 1];
  if (i < j) block.transposeInPlace();
  return block;
}

bool Filter::finish_update(const Observation* observations, int count, const unsigned char* keep, Scalar* nis) {
  // Close the gaps that rejected observations leave in H P and S, and add the noise.
  int m = 0;
  for (int i = 0; i < count; ++i) {
    if (keep != nullptr && keep[i] == 0) continue;
    for (int a = 0; a < 2; ++a) {
      const int from = 2 * i + a, to = m + a;
      if (from != to) std::memcpy(W_ + to * ld_, W_ + from * ld_, sizeof(Scalar) * static_cast<std::size_t>(ld_));
      int column = 0;
      for (int j = 0; j <= i; ++j) {
        if (keep != nullptr && keep[j] == 0) continue;
        S_[to * lds_ + column] = S_[from * lds_ + 2 * j];
        S_[to * lds_ + column + 1] = S_[from * lds_ + 2 * j + 1];
        column += 2;
      }
    }
    const Observation& o = observations[i];
    for (int a = 0; a < 2; ++a) {
      for (int b = 0; b <= a; ++b) S_[(m + a) * lds_ + m + b] += o.noise(a, b);
      y_[m + a] = o.measured[a] - o.predicted[a];
    }
    m += 2;
  }
  return m > 0 && apply(m, nis);
}

/// The update with the m rows H P in W_, S in S_ and residuals in y_. Held rows keep their values and their own covariance.
bool Filter::apply(int m, Scalar* nis) {
  const int n = state_.dim;
  if (!kernels_->cholesky(S_, m, lds_)) return false;
  kernels_->solve_lower(S_, m, lds_, W_, n, ld_);
  Scalar sum = 0;
  for (int i = 0; i < m; ++i) {  // y <- L^-1 y
    Scalar v = y_[i];
    for (int k = 0; k < i; ++k) v -= S_[i * lds_ + k] * y_[k];
    y_[i] = v / S_[i * lds_ + i];
    sum += y_[i] * y_[i];
  }
  if (!(sum < Scalar(1e12))) return false;
  if (nis != nullptr) *nis = sum;

  kernels_->combine(W_, m, n, ld_, y_, dx_);
  for (int i = state_.body_dim; i < state_.held_end(); ++i) dx_[i] = Scalar(0);
  if (!is_step(dx_)) return false;

  int rows = 0;
  if (keep_gauge_) rows = begin_transport();
  apply_error(state_, dx_);
  if (keep_gauge_) finish_transport(m, rows);
  kernels_->downdate(P_, W_, m, U_, G_, rows, ld_, state_.body_dim, state_.held_end());
  return true;
}

}  // namespace pf
