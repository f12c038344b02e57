#include <utility>

#include "filter/block_filter.h"

/// Blocks that only some measurements of an update estimate. With these first, L L^T = S + R, and W = L^-1 H P, the first rows of W and
/// y = L^-1 r are those of an update by them alone.

namespace pf {

/// Exchanges two rows of H P, S and r, a < b.
void BlockFilter::swap_gained(int a, int b) {
  std::swap_ranges(W_ + a * ld_, W_ + a * ld_ + P_.n, W_ + b * ld_);
  std::swap(y_[a], y_[b]);
  const auto S = [&](int i, int j) -> Scalar& { return S_[i * lds_ + j]; };
  for (int k = 0; k < a; ++k) std::swap(S(a, k), S(b, k));
  for (int k = a + 1; k < b; ++k) std::swap(S(k, a), S(b, k));
  for (int k = b + 1; k < gained_; ++k) std::swap(S(k, a), S(k, b));
  std::swap(S(a, a), S(b, b));
}

/// Of the kept rows. Returns how many estimate.
int BlockFilter::put_estimating_first(const Measurement* z, int count, const unsigned char* keep) {
  int estimating = 0, row = 0;
  for (int i = 0; i < count; ++i) {
    if (keep != nullptr && keep[i] == 0) continue;
    for (const int end = row + z[i].rows(); row < end; ++row) {
      if (partly_.estimates[i] == 0) continue;
      if (estimating != row) swap_gained(estimating, row);
      ++estimating;
    }
  }
  return estimating;
}

/// dx of these blocks: W^T y of the first rows.
void BlockFilter::step_partly() {
  for (int k = 0; k < partly_.count; ++k) {
    const Segment& rows = at_[partly_.block[k]];
    for (int i = rows.first; i < rows.first + rows.size; ++i) {
      dx_[i] = 0;
      for (int r = 0; r < estimating_; ++r) dx_[i] += W_[r * ld_ + i] * y_[r];
    }
  }
}

/// Where rows i and j are estimated by the first m_i and m_j rows of an update, P_ij loses W_i^T W_j of the first max(m_i, m_j): their
/// estimates differ by what the rows between bring, which is independent of the error of the other. downdate() has taken that of all rows
/// from pairs of these blocks, and of these blocks with what is considered (m = 0); this gives back that of those behind the first ones.
void BlockFilter::return_partly() {
  const auto give = [&](int i, int j) {
    Scalar sum = 0;
    for (int r = estimating_; r < gained_; ++r) sum += W_[r * ld_ + i] * W_[r * ld_ + j];
    P_.set(i, j, P_(i, j) + sum);
  };
  const RowRange& never = gain_considers_;
  const auto is_never = [&](int i) { return i >= never.begin && i < never.end; };
  for (int k = 0; k < partly_.count; ++k) {
    const Segment& a = at_[partly_.block[k]];
    for (int i = a.first; i < a.first + a.size; ++i) {
      if (is_never(i)) continue;
      for (int j = never.begin; j < never.end; ++j) give(i, j);
      for (int l = 0; l < partly_.count; ++l) {
        const Segment& b = at_[partly_.block[l]];
        for (int j = b.first; j < b.first + b.size; ++j)
          if (j <= i && !is_never(j)) give(i, j);
      }
    }
  }
}

}  // namespace pf
