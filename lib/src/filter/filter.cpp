#include "filter/filter.h"

#include <cstring>

#include "filter/observe/inverse_depth.h"
#include "filter/observe/point.h"

namespace pf {
namespace {

constexpr int kGaugeRows = 4;  // three turns and the scale

int round_to_group(int n) { return (n + Triangle::kGroup - 1) / Triangle::kGroup * Triangle::kGroup; }

template <int Rows, int Columns>
void put(Scalar* h, int stride, int column, const Eigen::Matrix<Scalar, Rows, Columns>& J) {
  for (int i = 0; i < Rows; ++i)
    for (int j = 0; j < Columns; ++j) h[i * stride + column + j] = J(i, j);
}

}  // namespace

bool Filter::layout(Arena& arena, const FilterCapacity& capacity) {
  most_rows_ = capacity.state_dim;
  P_.capacity = round_to_group(capacity.state_dim);
  P_.data = arena.take<Scalar>(Triangle::size_for(P_.capacity));
  state_.slots = capacity.state_dim / 3;  // a block has three rows
  state_.block = arena.take<Block>(static_cast<std::size_t>(state_.slots));
  max_rows_ = 2 * capacity.observations;
  ld_ = padded(P_.capacity);
  lds_ = padded(max_rows_);
  const std::size_t ld = static_cast<std::size_t>(ld_);
  W_ = arena.take<Scalar>(static_cast<std::size_t>(max_rows_) * ld);
  S_ = arena.take<Scalar>(static_cast<std::size_t>(max_rows_) * static_cast<std::size_t>(lds_));
  U_ = arena.take<Scalar>(kGaugeRows * ld);
  G_ = arena.take<Scalar>(kGaugeRows * ld);
  dx_ = arena.take<Scalar>(ld);
  y_ = arena.take<Scalar>(static_cast<std::size_t>(max_rows_));
  gone_ = arena.take<Segment>(static_cast<std::size_t>(state_.slots));
  return arena.ok();
}

void Filter::init(const Kernels* kernels, int body_dim, bool keep_gauge) {
  kernels_ = kernels;
  keep_gauge_ = keep_gauge;
  for (int s = 0; s < state_.slots; ++s) state_.block[s] = Block();
  state_.body = Body();
  state_.body_dim = body_dim;
  state_.dim = body_dim;
  P_.n = body_dim;
  std::memset(P_.data, 0, sizeof(Scalar) * Triangle::size_for(P_.capacity));
  const std::size_t ld = static_cast<std::size_t>(ld_);
  std::memset(W_, 0, sizeof(Scalar) * static_cast<std::size_t>(max_rows_) * ld);
  std::memset(U_, 0, sizeof(Scalar) * kGaugeRows * ld);
  std::memset(G_, 0, sizeof(Scalar) * kGaugeRows * ld);
}

void Filter::set_body(const Body& body, const Scalar* covariance) {
  PF_ASSERT(state_.dim == state_.body_dim);
  state_.body = body;
  for (int i = 0; i < state_.body_dim; ++i)
    for (int j = 0; j <= i; ++j) P_.set(i, j, covariance[i * state_.body_dim + j]);
}

void Filter::predict(const Transition& transition) {
  kernels_->predict(P_, transition.F, transition.Q, transition.dim);
}

void Filter::steer(const Vec3& dv_C, const Vec3& dw_C) {
  PF_ASSERT(state_.body_dim == Body::kMaxDim);
  const Vec3 dv_W = state_.body.q_WC * dv_C;
  state_.body.v_W += dv_W;
  state_.body.w_C += dw_C;
  if (dv_W.squaredNorm() == Scalar(0)) return;
  Transition turn = {};
  turn.dim = Body::kMaxDim;
  for (int i = 0; i < turn.dim; ++i) turn.F[i * turn.dim + i] = Scalar(1);
  const Mat3 J = -hat(dv_W);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) turn.F[(Body::kVelocity + i) * turn.dim + Body::kTheta + j] = J(i, j);
  kernels_->predict(P_, turn.F, turn.Q, turn.dim);
}

void Filter::damp(Scalar factor) {
  PF_ASSERT(state_.body_dim == Body::kMaxDim);
  state_.body.v_W *= factor;
  state_.body.w_C *= factor;
  Transition shrink = {};
  shrink.dim = Body::kMaxDim;
  for (int i = 0; i < shrink.dim; ++i) shrink.F[i * shrink.dim + i] = i < Body::kVelocity ? Scalar(1) : factor;
  kernels_->predict(P_, shrink.F, shrink.Q, shrink.dim);
}

int Filter::take_slot(BlockKind kind, int size) {
  const int slot = state_.find_free();
  if (slot < 0 || state_.dim + size > most_rows_) return -1;
  Block& block = state_.block[slot];
  block = Block();
  block.kind = kind;
  block.first = static_cast<std::int16_t>(state_.dim);
  block.size = static_cast<std::int16_t>(size);
  return slot;
}

int Filter::add_anchor() {
  const int slot = take_slot(BlockKind::kAnchor, 3);
  if (slot < 0) return -1;
  SparseRows J;  // o = p
  J.rows = 3;
  J.segments = 1;
  J.segment[0] = {Body::kPosition, 3};
  put<3, 3>(J.h, 3, 0, Mat3::Identity());
  const Scalar none[9] = {};
  kernels_->augment(P_, J, none);
  state_.block[slot].set_xyz(state_.body.p_W);
  state_.dim = P_.n;
  return slot;
}

int Filter::add_inverse_depth(int anchor, const Vec3& ray_C, const Mat32& J_ray_z, const Mat2& noise_px, Scalar rho,
                              Scalar sigma_rho) {
  PF_ASSERT(state_.block[anchor].kind == BlockKind::kAnchor);
  const int slot = take_slot(BlockKind::kInverseDepth, 3);
  if (slot < 0) return -1;
  Mat23 J_theta;
  Mat2 J_z;
  const InverseDepth feature = begin_inverse_depth(state_.body, ray_C, J_ray_z, rho, &J_theta, &J_z);
  SparseRows J;
  J.rows = 3;
  J.segments = 1;
  J.segment[0] = {Body::kTheta, 3};
  put<2, 3>(J.h, 3, 0, J_theta);
  J.h[6] = J.h[7] = J.h[8] = Scalar(0);
  Mat3 noise = Mat3::Zero();
  const Mat2 Jn = J_z * noise_px;
  noise.topLeftCorner<2, 2>() = Jn * J_z.transpose();
  noise(2, 2) = sigma_rho * sigma_rho;
  Scalar raw[9];
  put<3, 3>(raw, 3, 0, noise);
  kernels_->augment(P_, J, raw);
  state_.block[slot].set_inverse_depth(feature);
  state_.block[slot].parent = static_cast<std::int16_t>(anchor);
  ++state_.block[anchor].children;
  state_.dim = P_.n;
  return slot;
}

int Filter::add_point(const Vec3& p_W, const Mat3& covariance) {
  const int slot = take_slot(BlockKind::kPoint, 3);
  if (slot < 0) return -1;
  SparseRows J;
  J.rows = 3;
  J.segments = 0;
  Scalar raw[9];
  put<3, 3>(raw, 3, 0, covariance);
  kernels_->augment(P_, J, raw);
  state_.block[slot].set_xyz(p_W);
  state_.dim = P_.n;
  return slot;
}

void Filter::convert_to_point(int slot) {
  Block& block = state_.block[slot];
  PF_ASSERT(block.kind == BlockKind::kInverseDepth);
  const int anchor = block.parent;
  Mat3 J_feature;
  const Vec3 f_W = inverse_depth_to_point(state_.block[anchor].xyz(), block.inverse_depth(), &J_feature);
  SparseRows J;  // f = o + b / rho
  J.rows = 3;
  J.segments = 2;
  J.segment[0] = {state_.block[anchor].first, 3};
  J.segment[1] = {block.first, 3};
  put<3, 3>(J.h, 6, 0, Mat3::Identity());
  put<3, 3>(J.h, 6, 3, J_feature);
  kernels_->transform(P_, block.first, 3, J, nullptr);
  block.kind = BlockKind::kPoint;
  block.parent = -1;
  block.set_xyz(f_W);
  --state_.block[anchor].children;
  if (state_.block[anchor].children == 0) remove(&anchor, 1);
}

void Filter::remove(const int* slots, int count) {
  // Mark, let anchors follow their last child, then list what goes in the order of rows.
  for (int i = 0; i < count; ++i) {
    Block& block = state_.block[slots[i]];
    if (block.kind == BlockKind::kInverseDepth) --state_.block[block.parent].children;
    block.kind = BlockKind::kNone;
  }
  for (int s = 0; s < state_.slots; ++s) {
    Block& block = state_.block[s];
    if (block.kind == BlockKind::kAnchor && block.children == 0) block.kind = BlockKind::kNone;
  }
  int gone = 0;
  for (int s = 0; s < state_.slots; ++s) {
    Block& block = state_.block[s];
    if (block.kind != BlockKind::kNone || block.first < 0) continue;
    int at = gone++;
    for (; at > 0 && gone_[at - 1].first > block.first; --at) gone_[at] = gone_[at - 1];
    gone_[at] = {block.first, block.size};
  }
  if (gone == 0) return;
  kernels_->remove(P_, gone_, gone);
  for (int s = 0; s < state_.slots; ++s) {
    Block& block = state_.block[s];
    if (block.kind == BlockKind::kNone) {
      block = Block();
      continue;
    }
    int shift = 0;
    for (int g = 0; g < gone && gone_[g].first < block.first; ++g) shift += gone_[g].size;
    block.first = static_cast<std::int16_t>(block.first - shift);
  }
  state_.dim = P_.n;
}

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
    out->second_order.setZero();
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
    Scalar p0 = 0, p1 = 0;  // row i of P H^T
    for (int j = 0; j < c; ++j) {
      const Scalar p = P_(column[i], column[j]);
      p0 += p * h0[j];
      p1 += p * h1[j];
    }
    s00 += h0[i] * p0;
    s01 += h0[i] * p1;
    s11 += h1[i] * p1;
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

void Filter::begin_update(const Observation* observations, int count) {
  PF_ASSERT(2 * count <= max_rows_);
  SparseRows rows;
  for (int j = 0; j < count; ++j) {
    sparse(observations[j], &rows);
    kernels_->gather(P_, rows, W_ + 2 * j * ld_, ld_);
  }
  for (int i = 0; i < count; ++i) {
    const Observation& o = observations[i];
    const int columns = o.segments == 2 ? 9 : 12;
    for (int j = 0; j <= i; ++j) {
      for (int b = 0; b < 2; ++b) {
        const Scalar* w = W_ + (2 * j + b) * ld_;
        Scalar s0 = 0, s1 = 0;
        int c = 0;
        for (int s = 0; s < o.segments; ++s) {
          const Scalar* p = w + o.segment[s].first;
          for (int k = 0; k < o.segment[s].size; ++k, ++c) {
            s0 += o.h[c] * p[k];
            s1 += o.h[columns + c] * p[k];
          }
        }
        S_[(2 * i) * lds_ + 2 * j + b] = s0;
        S_[(2 * i + 1) * lds_ + 2 * j + b] = s1;
      }
    }
  }
}

Mat2 Filter::innovation_block(int i, int j) const {
  Mat2 block;
  if (i >= j)
    block << S_[2 * i * lds_ + 2 * j], S_[2 * i * lds_ + 2 * j + 1], S_[(2 * i + 1) * lds_ + 2 * j],
        S_[(2 * i + 1) * lds_ + 2 * j + 1];
  else
    block << S_[2 * j * lds_ + 2 * i], S_[(2 * j + 1) * lds_ + 2 * i], S_[2 * j * lds_ + 2 * i + 1],
        S_[(2 * j + 1) * lds_ + 2 * i + 1];
  return block;
}

bool Filter::finish_update(const Observation* observations, int count, const unsigned char* keep, Scalar* nis) {
  const int n = state_.dim;
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
  if (m == 0) return false;
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
  if (!is_step(dx_)) return false;

  if (!keep_gauge_) {
    apply_error(state_, dx_);
    kernels_->downdate(P_, W_, m, nullptr, nullptr, 0, ld_, 0, 0);
    return true;
  }

  // Transport: M = I + U^T V takes the gauge directions at x- to those at x+; U holds their change, V = [E; l] picks the turn and
  // the log scale out of an error. With P1 = P - W^T W:   M P1 M^T = P1 + U^T G + G^T U,   G = V P1 + (V P1 V^T) U / 2.
  SparseRows l;
  const bool has_scale = scale_row(&l);
  std::memset(U_, 0, sizeof(Scalar) * kGaugeRows * static_cast<std::size_t>(ld_));
  add_gauge_rows(state_, Scalar(-1), U_, U_ + 3 * ld_, ld_);
  SparseRows E;
  E.rows = 3;
  E.segments = 1;
  E.segment[0] = {Body::kTheta, 3};
  put<3, 3>(E.h, 3, 0, Mat3::Identity());
  kernels_->gather(P_, E, G_, ld_);
  const int k = has_scale ? 4 : 3;
  if (has_scale) kernels_->gather(P_, l, G_ + 3 * ld_, ld_);

  apply_error(state_, dx_);
  add_gauge_rows(state_, Scalar(1), U_, U_ + 3 * ld_, ld_);

  const auto pick = [&](const Scalar* row, int which) {  // V applied to a row over the state
    if (which < 3) return row[Body::kTheta + which];
    Scalar v = 0;
    int c = 0;
    for (int s = 0; s < l.segments; ++s)
      for (int i = 0; i < l.segment[s].size; ++i) v += l.h[c++] * row[l.segment[s].first + i];
    return v;
  };
  for (int r = 0; r < k; ++r) {  // V P1 = V P - (V W^T) W
    Scalar* g = G_ + r * ld_;
    for (int j = 0; j < m; ++j) {
      const Scalar* w = W_ + j * ld_;
      const Scalar v = pick(w, r);
      for (int i = 0; i < n; ++i) g[i] -= v * w[i];
    }
  }
  Scalar VPV[kGaugeRows][kGaugeRows];
  for (int r = 0; r < k; ++r)
    for (int c = 0; c < k; ++c) VPV[r][c] = pick(G_ + r * ld_, c);
  for (int r = 0; r < k; ++r) {
    Scalar* g = G_ + r * ld_;
    for (int c = 0; c < k; ++c) {
      const Scalar half = (VPV[r][c] + VPV[c][r]) / Scalar(4);
      const Scalar* u = U_ + c * ld_;
      for (int i = 0; i < n; ++i) g[i] += half * u[i];
    }
  }
  kernels_->downdate(P_, W_, m, U_, G_, k, ld_, 0, 0);
  return true;
}

bool Filter::scale_row(SparseRows* row) const {
  // The best known of a few log lengths: between a point and the far ones among the points, or a log inverse depth.
  Scalar best = Scalar(0);
  bool found = false;
  int tried = 0;
  for (int s = 0; s < state_.slots && tried < 12; ++s) {
    const Block& a = state_.block[s];
    SparseRows candidate;
    candidate.rows = 1;
    if (a.kind == BlockKind::kInverseDepth) {
      const Scalar rho = a.inverse_depth().rho;
      if (!(rho > Scalar(1e-6))) continue;
      candidate.segments = 1;
      candidate.segment[0] = {a.first, 3};
      candidate.h[0] = candidate.h[1] = Scalar(0);
      candidate.h[2] = Scalar(-1) / rho;
      const Scalar variance = P_(a.first + 2, a.first + 2) / (rho * rho);
      ++tried;
      if (found && variance >= best) continue;
      best = variance;
      found = true;
      *row = candidate;
      continue;
    }
    if (a.kind != BlockKind::kPoint) continue;
    int far = -1;
    Scalar far2 = Scalar(0);
    for (int t = 0; t < state_.slots; ++t) {
      if (state_.block[t].kind != BlockKind::kPoint) continue;
      const Scalar d2 = (state_.block[t].xyz() - a.xyz()).squaredNorm();
      if (d2 > far2) {
        far2 = d2;
        far = t;
      }
    }
    if (far < 0 || !(far2 > Scalar(1e-12))) continue;
    ++tried;
    const Block& b = state_.block[far];
    const Vec3 d = a.xyz() - b.xyz();
    candidate.segments = 2;
    candidate.segment[0] = {a.first, 3};
    candidate.segment[1] = {b.first, 3};
    for (int i = 0; i < 3; ++i) {
      candidate.h[i] = d[i] / far2;
      candidate.h[3 + i] = -d[i] / far2;
    }
    Scalar variance = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        variance += candidate.h[i] * candidate.h[j] *
                    (P_(a.first + i, a.first + j) + P_(b.first + i, b.first + j) - P_(a.first + i, b.first + j) -
                     P_(b.first + i, a.first + j));
    if (found && variance >= best) continue;
    best = variance;
    found = true;
    *row = candidate;
  }
  return found;
}

Vec3 Filter::point(int slot) const {
  const Block& block = state_.block[slot];
  if (block.kind != BlockKind::kInverseDepth) return block.xyz();
  constexpr Scalar kFar = Scalar(1e-3);
  const InverseDepth d = block.inverse_depth();
  const Scalar rho = d.rho > kFar ? d.rho : kFar;
  return state_.block[block.parent].xyz() + d.q_b.toRotationMatrix().col(2) / rho;
}

Mat3 Filter::covariance3(int slot) const {
  const int first = state_.block[slot].first;
  Mat3 C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) C(i, j) = P_(first + i, first + j);
  return C;
}

}  // namespace pf
