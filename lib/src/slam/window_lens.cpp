#include "slam/window_lens.h"

#include <algorithm>

#include "geometry/small_cholesky.h"

namespace pf {

void WindowLens::init(const Camera& calibration, const LensPrior& prior) {
  rows_ = prior.rows;
  camera_ = calibration;
  std::copy(prior.covariance, prior.covariance + kMaxEntries, covariance_);
}

void WindowLens::set_covariance(const Scalar* covariance, Scalar inflation) {
  for (int i = 0; i < rows_.count * rows_.count; ++i) covariance_[i] = inflation * covariance[i];
}

/// The covariance of a prior is positive definite.
void lens_information(const LensPrior& prior, Scalar inflation, Scalar* information) {
  const int n = prior.rows.count;
  Scalar L[WindowLens::kMaxEntries];
  std::copy(prior.covariance, prior.covariance + n * n, L);
  factor_cholesky(L, n, n);
  for (int c = 0; c < n; ++c) {
    Scalar x[kLensParameters] = {};
    x[c] = inflation;
    solve_cholesky(L, n, n, x);
    for (int a = 0; a < n; ++a) information[a * n + c] = x[a];
  }
}

}  // namespace pf
