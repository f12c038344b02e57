#include <cstring>

#include "filter/filter.h"

/// The update with pixels.

namespace pf {
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
