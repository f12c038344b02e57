#include "filter/transport.h"

#include <climits>
#include <cstring>

#include "filter/state_rows.h"
#include "geometry/so3.h"

namespace pf {
namespace {

constexpr int kRotation = 0, kScale = 3, kTranslation = 4;
static_assert(kTranslation == Kernels::kDenseRows);

/// A row of a Jacobian times a dense row, of which columns before `begin` and from `end` on count as zero.
Scalar dot(const BlockFilter& blocks, const ScaleRow& row, const Scalar* dense, int begin = 0, int end = INT_MAX) {
  Scalar v = 0;
  int c = 0;
  for (int p = 0; p < row.parts; ++p) {
    const int first = blocks.row(row.part[p]);
    for (int i = 0; i < row.part[p].size; ++i, ++c)
      if (first + i >= begin && first + i < end) v += row.h[c] * dense[first + i];
  }
  return v;
}

/// Adds sign times what a translation does to the heights of planes; all that it does to other rows is the same at every x.
void add_height_rows(const State& state, const BlockFilter& blocks, Scalar sign, Scalar* U_translation, int ld) {
  for (int s = 0; s < state.slots; ++s) {
    const Block& block = state.block[s];
    if (block.kind != BlockKind::kPlane) continue;
    const int height = blocks.first(s) + 2;
    const Vec3 translation = plane_gauge(state.frame_of(block), block.xyz()).block<1, 3>(2, 0).transpose();
    for (int axis = 0; axis < 3; ++axis)
      if (gauge::contains(state.unobservable, gauge::kTranslation + axis))
        U_translation[axis * ld + height] += sign * translation(axis);
  }
}

}  // namespace

bool Transport::layout(Arena& arena, int ld) {
  ld_ = ld;
  U_ = arena.take<Scalar>(static_cast<std::size_t>(kMaxRows) * static_cast<std::size_t>(ld));
  G_ = arena.take<Scalar>(static_cast<std::size_t>(kMaxRows) * static_cast<std::size_t>(ld));
  return arena.ok();
}

void Transport::init() {
  rows_ = 0;
  l_.parts = 0;
  const std::size_t bytes = sizeof(Scalar) * static_cast<std::size_t>(kMaxRows) * static_cast<std::size_t>(ld_);
  std::memset(U_, 0, bytes);
  std::memset(G_, 0, bytes);
}

void Transport::begin(const State& state, const BlockFilter& blocks, const ScaleRow& l) {
  l_ = l;
  rows_ = state.planes > 0 ? kMaxRows : l_.parts > 0 ? kTranslation : kScale;
  const std::size_t row_bytes = sizeof(Scalar) * static_cast<std::size_t>(ld_);
  std::memset(U_, 0, kMaxRows * row_bytes);
  std::memset(G_, 0, static_cast<std::size_t>(rows_) * row_bytes);
  add_gauge_rows(state, blocks, Scalar(-1), nullptr, U_, U_ + kScale * ld_, ld_);
  if (rows_ == kMaxRows) add_height_rows(state, blocks, Scalar(-1), U_ + kTranslation * ld_, ld_);
  const Scalar identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const Part rotation = Part::body(Body::kTheta, 3), position = Part::body(Body::kPosition, 3);
  const Rows V[3] = {{3, 1, &rotation, identity}, l_.view(), {3, 1, &position, identity}};
  blocks.gather(V, rows_ == kMaxRows ? 3 : rows_ == kTranslation ? 2 : 1, G_);
  p_before_ = state.body.p_W;
}

const Scalar* Transport::scale_direction(const State& state, const BlockFilter& blocks) {
  std::memset(U_, 0, sizeof(Scalar) * static_cast<std::size_t>(kMaxRows) * static_cast<std::size_t>(ld_));
  add_gauge_rows(state, blocks, Scalar(1), nullptr, U_, U_ + kScale * ld_, ld_);
  return U_ + kScale * ld_;
}

void Transport::spread(const State& state, const BlockFilter& blocks, const GaugePrior::Matrix& V) {
  constexpr int kDirection[kMaxRows] = {3, 4, 5, gauge::kScale, 0, 1, 2};  // of the rows of U
  const std::size_t bytes = sizeof(Scalar) * static_cast<std::size_t>(kMaxRows) * static_cast<std::size_t>(ld_);
  rows_ = kMaxRows;
  std::memset(U_, 0, bytes);
  std::memset(G_, 0, bytes);
  add_gauge_rows(state, blocks, Scalar(1), U_ + kTranslation * ld_, U_, U_ + kScale * ld_, ld_);
  Scalar half[kMaxRows * kMaxRows];
  for (int r = 0; r < kMaxRows; ++r)
    for (int c = 0; c < kMaxRows; ++c) half[r * kMaxRows + c] = V(kDirection[r], kDirection[c]) / Scalar(2);
  blocks.kernels().add_product(G_, kMaxRows, half, kMaxRows, U_, kMaxRows, blocks.dim(), ld_);
}

void Transport::finish(const State& state, const BlockFilter& blocks) {
  const int n = blocks.dim(), m = blocks.gained_rows(), rows = rows_;
  const Kernels& kernels = blocks.kernels();
  add_gauge_rows(state, blocks, Scalar(1), nullptr, U_, U_ + kScale * ld_, ld_);
  if (rows == kMaxRows) add_height_rows(state, blocks, Scalar(1), U_ + kTranslation * ld_, ld_);
  if (l_.parts == 0) std::memset(U_ + kScale * ld_, 0, sizeof(Scalar) * static_cast<std::size_t>(ld_));

  const auto raw = [&](const Scalar* row, int which) {  // E_theta, l, E_p
    if (which < kScale) return row[Body::kTheta + which];
    return which == kScale ? dot(blocks, l_, row) : row[Body::kPosition + which - kTranslation];
  };
  // Of P1: less (V W^T) W, as long as V touches no considered row, as it does in an update that considers all of the map, or the body.
  constexpr int kChunk = 64;
  Scalar A[kMaxRows * kChunk];
  for (int first = 0; first < m; first += kChunk) {
    const int terms = m - first < kChunk ? m - first : kChunk;
    for (int j = 0; j < terms; ++j)
      for (int r = 0; r < rows; ++r) A[r * kChunk + j] = -raw(blocks.whitened(first + j), r);
    kernels.add_product(G_, rows, A, kChunk, blocks.whitened(first), terms, n, ld_);
  }
  add_considered(blocks);
  const Mat3 p_hat = hat(p_before_);
  if (rows == kMaxRows) {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < kTranslation; ++b) A[a * kTranslation + b] = b < kScale ? p_hat(a, b) : -p_before_[a];
    kernels.add_product(G_ + kTranslation * ld_, 3, A, kTranslation, G_, kTranslation, n, ld_);
  }
  const auto pick = [&](const Scalar* row, int which) {
    if (which < kTranslation) return raw(row, which);
    const int a = which - kTranslation;
    Scalar v = raw(row, which) - p_before_[a] * raw(row, kScale);
    for (int b = 0; b < 3; ++b) v += p_hat(a, b) * raw(row, b);
    return v;
  };
  Scalar VPV[kMaxRows][kMaxRows];
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < rows; ++c) VPV[r][c] = pick(G_ + r * ld_, c);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < rows; ++c) A[r * kMaxRows + c] = (VPV[r][c] + VPV[c][r]) / Scalar(4);
  kernels.add_product(G_, rows, A, kMaxRows, U_, rows, n, ld_);
}

/// P1 takes nothing from P between considered rows c: row v of V there is less (v_e W_e^T) W_c only, with the other rows e.
void Transport::add_considered(const BlockFilter& blocks) {
  const int begin = blocks.gain_considers().begin, end = blocks.gain_considers().end;
  const bool considers_body = begin == 0;
  if (end <= blocks.held_end() && !considers_body) return;
  for (int j = 0; j < blocks.gained_rows(); ++j) {
    const Scalar* const W_j = blocks.whitened(j);
    const auto add = [&](int row, Scalar v_W) {
      for (int c = begin; c < end; ++c) G_[row * ld_ + c] += v_W * W_j[c];
    };
    for (int axis = 0; axis < 3 && considers_body; ++axis) {
      add(kRotation + axis, W_j[Body::kTheta + axis]);
      if (rows_ == kMaxRows) add(kTranslation + axis, W_j[Body::kPosition + axis]);
    }
    if (rows_ >= kTranslation) add(kScale, dot(blocks, l_, W_j, begin, end));
  }
}

}  // namespace pf
