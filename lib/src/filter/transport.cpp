#include <cmath>
#include <cstring>

#include "filter/filter.h"
#include "filter/observe/world_point.h"
#include "filter/put.h"

/// Keeps the covariance consistent with what a bare camera cannot observe, when an update moves the state (lib/docs/gauge.md).
///
///   M = I + U^T V takes the gauge directions N at x- to those at x+:  U = N(x+) - N(x-),  V N(x-) = I
///   rows of V:  turn E_theta,  log scale l,  shift E_p + [p]x E_theta - p l         (body p at x-)
///   with P1 = P - W^T W:   M P1 M^T = P1 + U^T G + G^T U,   G = V P1 + (V P1 V^T) U / 2
///
/// Shifts are the same at every x but for planes, whose distance moves by n . t: without planes they need no rows. With them their rows
/// of U come last, zero but for the heights of planes, and the downdate spends nothing on what is zero.

namespace pf {
namespace {

constexpr int kTurn = 0, kScale = 3, kShift = 4;
static_assert(kShift == Kernels::kDenseRows);

/// A row of a Jacobian times a dense row.
Scalar dot(const SparseRows& row, const Scalar* dense) {
  Scalar v = 0;
  int c = 0;
  for (int s = 0; s < row.segments; ++s)
    for (int i = 0; i < row.segment[s].size; ++i) v += row.h[c++] * dense[row.segment[s].first + i];
  return v;
}

/// Adds a place's part of a row: d^T J.
void add_place(const WorldPoint& at, const Vec3& d, SparseRows* row) {
  int column = 0;
  for (int s = 0; s < at.segments; ++s) {
    Scalar h[WorldPoint::kMaxColumns];
    for (int i = 0; i < at.segment[s].size; ++i) h[i] = d.dot(at.J.col(column++));
    add_segment(row, at.segment[s], h);
  }
}

/// Adds sign times what a shift does to the heights of planes; all that it does to other rows is the same at every x.
void add_height_rows(const State& state, Scalar sign, Scalar* U_shift, int ld) {
  for (int s = 0; s < state.slots; ++s) {
    const Block& block = state.block[s];
    if (block.kind != BlockKind::kPlane) continue;
    const int height = block.first + 2;
    const Vec3 shift = plane_gauge(state.frame_of(block), block.xyz()).block<1, 3>(2, 0).transpose();
    for (int axis = 0; axis < 3; ++axis) U_shift[axis * ld + height] += sign * shift(axis);
  }
}

}  // namespace

/// Before the state moves: U = -N(x-), raw rows of V P in G. Returns how many rows the transport has.
int Filter::begin_transport() {
  const bool has_scale = scale_row(&l_);
  if (!has_scale) l_.segments = 0;
  const int rows = state_.planes > 0 ? kGaugeRows : has_scale ? kShift : kScale;
  const std::size_t bytes = sizeof(Scalar) * static_cast<std::size_t>(rows) * static_cast<std::size_t>(ld_);
  std::memset(U_, 0, sizeof(Scalar) * kGaugeRows * static_cast<std::size_t>(ld_));
  std::memset(G_, 0, bytes);
  add_gauge_rows(state_, Scalar(-1), nullptr, U_, U_ + kScale * ld_, ld_);
  if (rows == kGaugeRows) add_height_rows(state_, Scalar(-1), U_ + kShift * ld_, ld_);
  SparseRows V[3];  // E_theta, l, E_p
  for (int i = 0; i < 3; i += 2) {
    V[i].rows = 3;
    V[i].segments = 1;
    V[i].segment[0] = {i == 0 ? Body::kTheta : Body::kPosition, 3};
    put<3, 3>(V[i].h, 3, 0, Mat3::Identity());
  }
  V[1] = l_;
  V[1].rows = 1;
  kernels_->gather_many(P_, V, rows == kGaugeRows ? 3 : rows == kShift ? 2 : 1, G_, ld_);
  p_before_ = state_.body.p_W;
  return rows;
}

/// After it has moved: U and G as above.
void Filter::finish_transport(int m, int rows) {
  const int n = state_.dim;
  add_gauge_rows(state_, Scalar(1), nullptr, U_, U_ + kScale * ld_, ld_);
  if (rows == kGaugeRows) add_height_rows(state_, Scalar(1), U_ + kShift * ld_, ld_);
  if (l_.segments == 0) std::memset(U_ + kScale * ld_, 0, sizeof(Scalar) * static_cast<std::size_t>(ld_));

  const auto raw = [&](const Scalar* row, int which) {  // E_theta, l, E_p
    if (which < kScale) return row[Body::kTheta + which];
    return which == kScale ? dot(l_, row) : row[Body::kPosition + which - kShift];
  };
  // Of P1: less (V W^T) W. V touches no held row, so held columns are as they should be.
  constexpr int kChunk = 64;
  Scalar A[kGaugeRows * kChunk];
  for (int first = 0; first < m; first += kChunk) {
    const int terms = m - first < kChunk ? m - first : kChunk;
    for (int j = 0; j < terms; ++j)
      for (int r = 0; r < rows; ++r) A[r * kChunk + j] = -raw(W_ + (first + j) * ld_, r);
    kernels_->add_product(G_, rows, A, kChunk, W_ + first * ld_, terms, n, ld_);
  }
  const Mat3 turn = hat(p_before_);
  if (rows == kGaugeRows) {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < kShift; ++b) A[a * kShift + b] = b < kScale ? turn(a, b) : -p_before_[a];
    kernels_->add_product(G_ + kShift * ld_, 3, A, kShift, G_, kShift, n, ld_);
  }
  const auto pick = [&](const Scalar* row, int which) {
    if (which < kShift) return raw(row, which);
    const int a = which - kShift;
    Scalar v = raw(row, which) - p_before_[a] * raw(row, kScale);
    for (int b = 0; b < 3; ++b) v += turn(a, b) * raw(row, b);
    return v;
  };
  Scalar VPV[kGaugeRows][kGaugeRows];
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < rows; ++c) VPV[r][c] = pick(G_ + r * ld_, c);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < rows; ++c) A[r * kGaugeRows + c] = (VPV[r][c] + VPV[c][r]) / Scalar(4);
  kernels_->add_product(G_, rows, A, kGaugeRows, U_, rows, n, ld_);
}

/// H P H^T of one row.
Scalar Filter::variance_of(const SparseRows& row) const {
  int column[SparseRows::kMaxColumns];
  int c = 0;
  for (int s = 0; s < row.segments; ++s)
    for (int i = 0; i < row.segment[s].size; ++i) column[c++] = row.segment[s].first + i;
  Scalar sum = 0;
  for (int i = 0; i < c; ++i) {
    Scalar before = 0;
    for (int j = 0; j < i; ++j) before += row.h[j] * P_(column[i], column[j]);
    sum += row.h[i] * (row.h[i] * P_(column[i], column[i]) + 2 * before);
  }
  return sum;
}

Mat3 Filter::relative_covariance(int slot, const SparseRows& l) const {
  const Block& block = state_.block[slot];
  PF_ASSERT(block.kind == BlockKind::kPoint);
  const Vec3 d = block.xyz() - state_.body.p_W;
  SparseRows row[3];
  for (int axis = 0; axis < 3; ++axis) {
    Scalar one[3] = {}, less[3] = {}, scaled[SparseRows::kMaxColumns];
    one[axis] = Scalar(1);
    less[axis] = Scalar(-1);
    row[axis].rows = 1;
    add_segment(&row[axis], {block.first, 3}, one);
    add_segment(&row[axis], {Body::kPosition, 3}, less);
    for (int s = 0, c = 0; s < l.segments; ++s) {
      for (int i = 0; i < l.segment[s].size; ++i) scaled[i] = -d[axis] * l.h[c++];
      add_segment(&row[axis], l.segment[s], scaled);
    }
  }
  int column[SparseRows::kMaxColumns];
  int columns = 0;
  for (int s = 0; s < row[0].segments; ++s)
    for (int i = 0; i < row[0].segment[s].size; ++i) column[columns++] = row[0].segment[s].first + i;
  Mat3 C = Mat3::Zero();
  for (int i = 0; i < columns; ++i) {  // rows of the lower triangle, half of the diagonal; then C + C^T
    Vec3 PJ = P_(column[i], column[i]) / 2 * Vec3(row[0].h[i], row[1].h[i], row[2].h[i]);
    for (int j = 0; j < i; ++j) PJ += P_(column[i], column[j]) * Vec3(row[0].h[j], row[1].h[j], row[2].h[j]);
    C += Vec3(row[0].h[i], row[1].h[i], row[2].h[i]) * PJ.transpose();
  }
  return C + C.transpose();
}

Scalar Filter::relative_sigma_rho(int slot, const SparseRows& l) const {
  const Block& block = state_.block[slot];
  PF_ASSERT(block.kind == BlockKind::kInverseDepth);
  const Scalar rho = block.inverse_depth().rho;
  const int first = block.first + 2;
  for (int s = 0; s < l.segments; ++s)  // the row hangs on this very point: it cannot be its own measure
    if (l.segment[s].first == block.first) return std::sqrt(P_(first, first));
  SparseRows row = l;
  row.rows = 1;
  for (int c = 0; c < l.columns(); ++c) row.h[c] *= rho;
  const Scalar one = Scalar(1);
  add_segment(&row, {first, 1}, &one);
  return std::sqrt(variance_of(row));
}

/// The best known of a few log lengths: a patch's lambda, a log inverse depth, or between a point and the one that is farthest from it.
/// Each annihilates shifts and turns, and grows by s when the world grows by exp(s). None touches held rows.
bool Filter::scale_row(SparseRows* row) const {
  constexpr int kMostTried = 12;
  int places = -1;  // of place_: the points, listed once they are asked for
  Scalar best = Scalar(0);
  bool found = false;
  int tried = 0;
  for (int s = 0; s < state_.slots && tried < kMostTried; ++s) {
    const Block& a = state_.block[s];
    SparseRows candidate;
    candidate.rows = 1;
    if (a.kind == BlockKind::kPatch) {
      const GaugeRows N = gauge_rows(state_, a);
      candidate.segments = 2;
      candidate.segment[0] = {Body::kTheta, 3};
      candidate.segment[1] = {a.first + 3, 1};
      for (int i = 0; i < 3; ++i) candidate.h[i] = -N(3, 3 + i);
      candidate.h[3] = Scalar(1);
    } else if (a.kind == BlockKind::kInverseDepth) {
      const Scalar rho = a.inverse_depth().rho;
      if (!(rho > Scalar(1e-6))) continue;
      candidate.segments = 1;
      candidate.segment[0] = {a.first, 3};
      candidate.h[0] = candidate.h[1] = Scalar(0);
      candidate.h[2] = Scalar(-1) / rho;
    } else if (a.kind == BlockKind::kPoint || a.kind == BlockKind::kPlanePoint) {
      if (places < 0) {
        places = 0;
        for (int t = 0; t < state_.slots; ++t) {
          if (state_.block[t].kind != BlockKind::kPoint && state_.block[t].kind != BlockKind::kPlanePoint) continue;
          place_slot_[places] = t;
          place_[places++] = point(t);
        }
      }
      const Vec3 here = point(s);
      int far = -1;
      Scalar far2 = Scalar(1e-12);
      for (int t = 0; t < places; ++t) {
        const Scalar d2 = (place_[t] - here).squaredNorm();
        if (d2 > far2) {
          far2 = d2;
          far = t;
        }
      }
      if (far < 0) continue;
      far = place_slot_[far];
      WorldPoint from, to;
      world_point(state_, s, &from);
      world_point(state_, far, &to);
      const Vec3 d = (from.p_W - to.p_W) / far2;
      candidate.segments = 0;
      add_place(from, d, &candidate);
      add_place(to, -d, &candidate);
    } else {
      continue;
    }
    ++tried;
    const Scalar variance = variance_of(candidate);
    if (found && variance >= best) continue;
    best = variance;
    found = true;
    *row = candidate;
  }
  return found;
}

}  // namespace pf
