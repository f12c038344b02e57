#include "filter/block_filter.h"

#include <cstring>

#include "covariance/open_gap.h"
#include "filter/located.h"

/// How blocks come, change and go. The update is in block_update.cpp.

namespace pf {
namespace {

int round_to_group(int n) { return (n + Triangle::kGroup - 1) / Triangle::kGroup * Triangle::kGroup; }

}  // namespace

bool BlockFilter::layout(Arena& arena, const Capacity& capacity) {
  max_dim_ = capacity.dim;
  P_.capacity = round_to_group(capacity.dim);
  P_.data = arena.take<Scalar>(Triangle::size_for(P_.capacity));
  blocks_ = capacity.blocks;
  at_ = arena.take<Segment>(static_cast<std::size_t>(blocks_));
  max_rows_ = capacity.rows;
  ld_ = padded(P_.capacity);
  lds_ = padded(max_rows_);
  const std::size_t ld = static_cast<std::size_t>(ld_), rows = static_cast<std::size_t>(max_rows_);
  W_ = arena.take<Scalar>(rows * ld);
  S_ = arena.take<Scalar>(rows * static_cast<std::size_t>(lds_));
  dx_ = arena.take<Scalar>(ld);
  y_ = arena.take<Scalar>(rows);
  gone_ = arena.take<Segment>(static_cast<std::size_t>(blocks_));
  order_ = arena.take<int>(ld);
  row_ = arena.take<int>(rows + 1);
  return arena.ok();
}

void BlockFilter::init(const Kernels* kernels, int leading_dim, int considered) {
  kernels_ = kernels;
  leading_dim_ = leading_dim;
  held_dim_ = considered_ = considered;
  P_.n = leading_dim + considered;
  gained_ = 0;
  owed_ = 0;
  for (int b = 0; b < blocks_; ++b) at_[b] = {-1, 0};
  std::memset(P_.data, 0, sizeof(Scalar) * Triangle::size_for(P_.capacity));
  std::memset(W_, 0, sizeof(Scalar) * static_cast<std::size_t>(max_rows_) * static_cast<std::size_t>(ld_));
}

void BlockFilter::set_leading(const Scalar* covariance, int rows, const Scalar* J) {
  PF_ASSERT(rows <= leading_dim_);
  const int others = held_end() - rows;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j <= i; ++j) P_.set(i, j, covariance[i * rows + j]);
  for (int i = 0; i < rows; ++i)
    for (int k = 0; k < P_.n - rows; ++k) {
      Scalar JP = 0;
      for (int l = 0; J != nullptr && k < others && l < others; ++l) JP += J[i * others + l] * P_(rows + l, rows + k);
      P_.set(rows + k, i, JP);
    }
  for (int i = 0; J != nullptr && i < rows; ++i)
    for (int j = 0; j <= i; ++j) {
      Scalar sum = P_(i, j);
      for (int k = 0; k < others; ++k) sum += P_(rows + k, i) * J[j * others + k];
      P_.set(i, j, sum);
    }
}

void BlockFilter::consider_last(int rows) {
  const int more = rows - considered_;
  PF_ASSERT(more <= leading_dim_);
  leading_dim_ -= more;
  held_dim_ += more;
  considered_ = rows;
}

void BlockFilter::set_constants(int first, const Scalar* covariance) {
  PF_ASSERT(P_.n == held_end());
  const int size = P_.n - first;
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < first; ++j) P_.set(first + i, j, Scalar(0));
    for (int j = 0; j <= i; ++j) P_.set(first + i, first + j, covariance[i * size + j]);
  }
}

void BlockFilter::predict(const Scalar* F, const Scalar* Q, int rows) {
  PF_ASSERT(rows <= leading_dim_);
  kernels_->predict(P_, F, Q, rows);
}

/// One row after the other: x_d += B_d c is a transition of its own, which leaves c and the other rows as they are.
void BlockFilter::add_constants(const Scalar* B, int rows, int first, int columns) {
  PF_ASSERT(first >= rows && first + columns <= leading_dim_);
  const auto is_empty = [&](int d) {
    for (int k = 0; k < columns; ++k)
      if (B[d * columns + k] != Scalar(0)) return false;
    return true;
  };
  for (int d = 0; d < rows; ++d) {
    if (is_empty(d)) continue;
    Scalar own = 0;  // 2 B P_cd + B P_cc B^T
    for (int k = 0; k < columns; ++k) {
      Scalar sum = 2 * P_(first + k, d);
      for (int l = 0; l < columns; ++l) sum += P_(first + k, first + l) * B[d * columns + l];
      own += sum * B[d * columns + k];
    }
    for (int x = 0; x < P_.n; ++x) {
      if (x == d) continue;
      Scalar sum = P_(x, d);
      for (int k = 0; k < columns; ++k) sum += P_(x, first + k) * B[d * columns + k];
      P_.set(x, d, sum);
    }
    P_.set(d, d, P_(d, d) + own);
  }
}

void BlockFilter::augment(int block, const Rows& J, const Scalar* Q) {
  PF_ASSERT(J.rows <= room());
  Located located;
  locate(J, &located);
  const Segment old = at_[block];
  at_[block] = {P_.n, J.rows};
  kernels_->augment(P_, located.rows, Q);
  if (old.size == 0) return;
  int gone = 0;
  list_gone(old.first, old.size, &gone);
  close_gaps(gone);
}

void BlockFilter::dense_begin(int rows) {
  PF_ASSERT(2 * rows <= max_rows_);
  std::memset(W_, 0, static_cast<std::size_t>(rows) * sizeof(Scalar) * static_cast<std::size_t>(ld_));
}

void BlockFilter::dense_add(const Rows& J) {
  const int entries = J.rows * ld_;
  gather(&J, 1, W_ + entries);
  for (int i = 0; i < entries; ++i) W_[i] += W_[entries + i];
}

/// Q += (J P) J_k^T
void BlockFilter::dense_square(const Rows& J, Scalar* Q) const {
  const int columns = J.columns(), first = row(J.part[0]);
  PF_ASSERT(J.parts == 1);
  for (int i = 0; i < J.rows; ++i)
    for (int j = 0; j < J.rows; ++j)
      for (int c = 0; c < columns; ++c) Q[i * J.rows + j] += W_[i * ld_ + first + c] * J.h[j * columns + c];
}

Scalar BlockFilter::dense_dot(const Rows& J) const {
  Scalar sum = 0;
  for (int p = 0, c = 0; p < J.parts; ++p)
    for (int i = 0; i < J.part[p].size; ++i) sum += J.h[c++] * W_[row(J.part[p]) + i];
  return sum;
}

/// P - N a^T - a N^T + factor N N^T, with a = P l^T in the first row of W: U = N, G = factor / 2 N - a.
void BlockFilter::take_out_dense(const Scalar* N, Scalar factor) {
  Scalar* const a = W_;
  for (int i = 0; i < ld_; ++i) a[i] = factor / 2 * N[i] - a[i];
  add_shared(N, a, 1);
}

void BlockFilter::add_shared(const Scalar* U, const Scalar* G, int rows) {
  kernels_->downdate(P_, W_, 0, U, G, rows, ld_, 0, 0);
}

void BlockFilter::dense_end(int block, int rows, Scalar* Q, Scalar own) {
  PF_ASSERT(rows <= room() && at_[block].size == 0);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < i; ++j) Q[rows * i + j] = Q[rows * j + i] = (Q[rows * i + j] + Q[rows * j + i]) / Scalar(2);
  for (int i = 0; i < rows; ++i) Q[(rows + 1) * i] += own * Q[(rows + 1) * i];
  const int n = P_.n;
  at_[block] = {n, rows};
  SparseRows none;
  none.rows = rows;
  kernels_->augment(P_, none, Q);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < n; ++j) P_.set(n + i, j, W_[i * ld_ + j]);
}

void BlockFilter::transform(int block, const Rows& J) {
  Located located;
  locate(J, &located);
  const Segment old = at_[block];
  int gone = 0;
  if (J.rows < old.size) list_gone(old.first + J.rows, old.size - J.rows, &gone);
  kernels_->transform(P_, old.first, old.size, located.rows, nullptr);
  at_[block].size = J.rows;
  move_up(gone);
}

void BlockFilter::transform(int* blocks, Rows* J, int count) {
  PF_ASSERT(count <= kBatch);
  for (int i = 1; i < count; ++i) {  // into the order of their rows
    const int block = blocks[i];
    const Rows rows = J[i];
    int to = i;
    for (; to > 0 && at_[blocks[to - 1]].first > at_[block].first; --to) {
      blocks[to] = blocks[to - 1];
      J[to] = J[to - 1];
    }
    blocks[to] = block;
    J[to] = rows;
  }
  Segment old[kBatch] = {};
  Located located[kBatch];
  SparseRows rows[kBatch];
  int gone = 0;
  for (int i = 0; i < count; ++i) {
    locate(J[i], &located[i]);
    rows[i] = located[i].rows;
    old[i] = at_[blocks[i]];
    if (rows[i].rows < old[i].size) list_gone(old[i].first + rows[i].rows, old[i].size - rows[i].rows, &gone);
  }
  kernels_->transform_many(P_, old, rows, count, W_, ld_, S_, lds_);
  for (int i = 0; i < count; ++i) at_[blocks[i]].size = rows[i].rows;
  move_up(gone);
}

void BlockFilter::hold(const int* blocks, int count) {
  const int n = P_.n, at = held_end();
  int gone = 0, size = 0;
  for (int k = 0; k < count; ++k) {
    list_gone(at_[blocks[k]].first, at_[blocks[k]].size, &gone);
    size += row_[k + 1] - row_[k];
  }
  for (int j = 0, stays = 0, g = 0; j < n; ++j) {  // where each row goes; -1: is one of those
    if (g < gone && j >= gone_[g].first + gone_[g].size) ++g;
    if (g < gone && j >= gone_[g].first)
      order_[j] = -1;
    else
      order_[j] = stays < at ? stays++ : size + stays++;
  }
  open_gap(P_, at, size, gone_, gone);
  for (int b = 0; b < blocks_; ++b)
    if (at_[b].size > 0 && at_[b].first >= at && order_[at_[b].first] >= 0) at_[b].first = order_[at_[b].first];
  for (int k = 0; k < count; ++k) at_[blocks[k]] = {at + row_[k], row_[k + 1] - row_[k]};
  for (int r = 0; r < size; ++r) {
    for (int j = 0; j < n; ++j)
      if (order_[j] >= 0) P_.set(at + r, order_[j], W_[r * ld_ + j]);
    for (int c = 0; c <= r; ++c) P_.set(at + r, at + c, S_[r * lds_ + c]);
  }
  held_dim_ += size;
}

void BlockFilter::remove(const int* blocks, int count) {
  int gone = 0;
  for (int k = 0; k < count; ++k) {
    Segment& at = at_[blocks[k]];
    if (at.size > 0) list_gone(at.first, at.size, &gone);
    at = {-1, 0};
  }
  close_gaps(gone);
}

/// Rows that go, kept in ascending order.
void BlockFilter::list_gone(int first, int size, int* gone) {
  int at = (*gone)++;
  for (; at > 0 && gone_[at - 1].first > first; --at) gone_[at] = gone_[at - 1];
  gone_[at] = {first, size};
}

/// Removes the listed rows in one pass.
void BlockFilter::close_gaps(int gone) {
  if (gone == 0) return;
  kernels_->remove(P_, gone_, gone);
  move_up(gone);
}

/// Blocks behind the listed rows, which the matrix has no more, move up.
void BlockFilter::move_up(int gone) {
  for (int b = 0; b < blocks_; ++b) {
    if (at_[b].size == 0) continue;
    int moved_up = 0;
    for (int g = 0; g < gone && gone_[g].first < at_[b].first; ++g) moved_up += gone_[g].size;
    at_[b].first -= moved_up;
  }
  const int end = held_end();
  for (int g = 0; g < gone; ++g)
    if (gone_[g].first < end) held_dim_ -= gone_[g].size;
}

Scalar BlockFilter::variance(const Rows& row) const { return covariance_of<1>(row)(0, 0); }

}  // namespace pf
