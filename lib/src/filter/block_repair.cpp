#include <algorithm>
#include <cmath>
#include <limits>

#include "filter/block_filter.h"
#include "filter/tuning.h"

/// Whether P can be a covariance, and what is done where it cannot (lib/docs/theory/float.md).

namespace pf {

using namespace tuning::soundness;

namespace {

const Scalar kBelowZero = sizeof(Scalar) == sizeof(float) ? kRoundingFloat : kRounding;

}  // namespace

/// Correlations C of the sample:  C + (r + g) I = L L^T, where r is what rounding may do and g = 0, or else the first of a growing series
/// of g; then P_ii <- (1 + r + g) P_ii. No g helps where a number is not finite.
BlockFilter::Repair BlockFilter::repair(int turn) {
  int row[kSample];
  Scalar scale[kSample];
  const int size = std::min({P_.n, kSample, max_rows_}), leading = std::min(leading_dim_, size);
  const int others = P_.n - leading, run = size - leading;
  const int from = others > 0 ? static_cast<int>(static_cast<long long>(turn) * run % others) : 0;
  for (int i = 0; i < size; ++i) {
    row[i] = i < leading ? i : leading + (from + i - leading) % others;
    const Scalar variance = P_(row[i], row[i]);
    scale[i] = variance > Scalar(0) ? Scalar(1) / std::sqrt(variance) : Scalar(0);
  }
  for (Scalar growth = 0; growth < kMaxRepair; growth = kStep * std::max(growth, kBelowZero)) {
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < i; ++j)
        S_[i * lds_ + j] = P_(std::max(row[i], row[j]), std::min(row[i], row[j])) * scale[i] * scale[j];
      S_[i * lds_ + i] = Scalar(1) + kBelowZero + growth;
    }
    if (!kernels_->cholesky(S_, size, lds_)) continue;
    if (growth == Scalar(0)) return Repair::kNone;
    for (int i = 0; i < size; ++i) P_.set(row[i], row[i], (Scalar(1) + kBelowZero + growth) * P_(row[i], row[i]));
    return Repair::kDone;
  }
  return Repair::kImpossible;
}

/// epsilon sum_i h_ri^2 P_ii
Scalar BlockFilter::rounding_of(const Rows& J, int r) const {
  int column[SparseRows::kMaxColumns];
  const int count = columns(J, column);
  Scalar sum = 0;
  for (int i = 0; i < count; ++i) sum += J.h[r * count + i] * J.h[r * count + i] * P_(column[i], column[i]);
  return std::numeric_limits<Scalar>::epsilon() * sum;
}

}  // namespace pf
