#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "filter/located.h"
#include "filter/tuning.h"

/// The update of the covariance: projection, gain, downdate.

namespace pf {
namespace {

// A row of H P H^T is a sum whose terms cancel where camera and point are wide together, so in float what rounding leaves of it may be
// larger than the noise of its pixel; then that is noise too. In double it is far below any noise.
constexpr bool kNoisyRounding = sizeof(Scalar) == sizeof(float);
constexpr Scalar kMaxNis = Scalar(1e12);  ///< a sum of squares that is larger is no number any more

}  // namespace

int BlockFilter::columns(const Rows& J, int* column) const {
  int c = 0;
  for (int p = 0; p < J.parts; ++p)
    for (int i = 0; i < J.part[p].size; ++i) column[c++] = row(J.part[p]) + i;
  return c;
}

void BlockFilter::gather(const Rows* J, int count, Scalar* out) const {
  Located located[kBatch];
  SparseRows rows[kBatch];
  PF_ASSERT(count <= kBatch);
  for (int i = 0; i < count; ++i) {
    locate(J[i], &located[i]);
    rows[i] = located[i].rows;
  }
  kernels_->gather_many(P_, rows, count, out, ld_);
}

/// A few measurements at a time, whose rows fit the stack.
void BlockFilter::project(const Measurement* z, int count) {
  row_[0] = 0;
  for (int i = 0; i < count; ++i) row_[i + 1] = row_[i] + z[i].rows();
  const int m = row_[count];
  PF_ASSERT(m <= max_rows_);
  Located located[kBatch];
  SparseRows rows[kBatch];
  const auto list = [&](int first) {
    const int size = count - first < kBatch ? count - first : kBatch;
    for (int j = 0; j < size; ++j) {
      locate(z[first + j].H, &located[j]);
      rows[j] = located[j].rows;
    }
    return size;
  };
  for (int i = 0; i < count; i += kBatch) {
    const int size = list(i);
    kernels_->gather_many(P_, rows, size, W_ + row_[i] * ld_, ld_);
  }
  for (int i = 0; i < count; i += kBatch) {
    const int size = count > kBatch ? list(i) : count;
    const int first = row_[i];
    kernels_->project(W_ + first * ld_, m - first, ld_, rows, size, S_ + first * (lds_ + 1), lds_);
  }
}

void BlockFilter::innovation(int i, int j, Scalar* S) const {
  const int rows = row_[i + 1] - row_[i], columns = row_[j + 1] - row_[j];
  for (int a = 0; a < rows; ++a)
    for (int b = 0; b < columns; ++b) {
      const int r = row_[i] + a, c = row_[j] + b;
      S[a * columns + b] = r >= c ? S_[r * lds_ + c] : S_[c * lds_ + r];
    }
}

Mat2 BlockFilter::innovation2(int i, int j) const {
  const Scalar* S = S_ + row_[i > j ? i : j] * lds_ + row_[i > j ? j : i];  // of the lower triangle
  Mat2 block;
  block << S[0], i == j ? S[lds_] : S[1], S[lds_], S[lds_ + 1];
  if (i < j) block.transposeInPlace();
  return block;
}

const Scalar* BlockFilter::gain(const Measurement* z, int count, const unsigned char* keep, const RowRange& considered,
                                const PartlyConsidered& partly, Scalar* nis) {
  // Close the gaps that rejected measurements leave in H P and S, and add the noise.
  int m = 0;
  for (int i = 0; i < count; ++i) {
    if (keep != nullptr && keep[i] == 0) continue;
    const int rows = z[i].rows();
    for (int a = 0; a < rows; ++a) {
      const int from = row_[i] + a, to = m + a;
      if (from != to) std::memcpy(W_ + to * ld_, W_ + from * ld_, sizeof(Scalar) * static_cast<std::size_t>(ld_));
      int column = 0;
      for (int j = 0; j <= i; ++j) {
        if (keep != nullptr && keep[j] == 0) continue;
        for (int c = row_[j]; c < row_[j + 1]; ++c) S_[to * lds_ + column++] = S_[from * lds_ + c];
      }
      for (int b = 0; b <= a; ++b) S_[to * lds_ + m + b] += z[i].R_update[a + b * rows];
      if (kNoisyRounding) S_[to * lds_ + to] += static_cast<Scalar>(z[i].H.columns()) * rounding_of(z[i].H, a);
      y_[to] = z[i].measured[a] - z[i].predicted[a];
    }
    m += rows;
  }
  gained_ = m;
  gain_considers_ = considered;
  partly_ = partly;
  estimating_ = partly.count > 0 ? put_estimating_first(z, count, keep) : m;
  if (m == 0 || !kernels_->cholesky(S_, m, lds_)) return nullptr;
  kernels_->solve_lower(S_, m, lds_, W_, P_.n, ld_);
  Scalar sum = 0;
  for (int i = 0; i < m; ++i) {  // y <- L^-1 y
    Scalar v = y_[i];
    for (int k = 0; k < i; ++k) v -= S_[i * lds_ + k] * y_[k];
    y_[i] = v / S_[i * lds_ + i];
    sum += y_[i] * y_[i];
  }
  if (!(sum < kMaxNis)) return nullptr;
  *nis = sum;
  kernels_->combine(W_, m, P_.n, ld_, y_, dx_);
  if (estimating_ < m) step_partly();
  for (int i = considered.begin; i < considered.end; ++i) dx_[i] = Scalar(0);
  return dx_;
}

void BlockFilter::downdate(const Scalar* U, const Scalar* G, int rows) {
  kernels_->downdate(P_, W_, gained_, U, G, rows, ld_, gain_considers_.begin, gain_considers_.end);
  if (estimating_ < gained_) return_partly();
}

/// What the downdate took of a variance is w^T w, w its column of L^-1 H P.
void BlockFilter::keep_rounding() {
  const Scalar kLeast = tuning::soundness::kDigits * std::numeric_limits<Scalar>::epsilon();
  Scalar* taken = dx_;
  std::fill(taken, taken + P_.n, Scalar(0));
  for (int k = 0; k < gained_; ++k)
    for (int i = 0; i < P_.n; ++i) taken[i] += W_[k * ld_ + i] * W_[k * ld_ + i];
  for (int i = 0; i < P_.n; ++i)
    if (P_(i, i) < kLeast * taken[i]) P_.set(i, i, kLeast * taken[i]);
}

/// With k = P h^T / (h P h^T), which is along the gain of an update by h, whether before it or after it: P + variance k k^T.
void BlockFilter::inflate_along(const Rows& row, Scalar variance) {
  PF_ASSERT(row.rows == 1 && max_rows_ >= 3);
  const Scalar of_row = std::max(covariance_of<1>(row)(0, 0), rounding_of(row, 0));
  if (!(of_row > Scalar(0))) return;
  gather(&row, 1, W_);                      // h P
  Scalar *U = W_ + ld_, *G = W_ + 2 * ld_;  // U^T G + G^T U with G = U / 2
  for (int j = 0; j < ld_; ++j) {
    U[j] = W_[j] * (std::sqrt(variance) / of_row);
    G[j] = U[j] / 2;
  }
  add_shared(U, G, 1);
}

}  // namespace pf
