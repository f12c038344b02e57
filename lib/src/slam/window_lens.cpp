#include "slam/window_lens.h"

#include <algorithm>

namespace pf {

void WindowLens::init(const Camera& calibration, const LensPrior& prior) {
  rows_ = prior.rows;
  camera_ = calibration;
  std::copy(prior.covariance, prior.covariance + kMaxEntries, covariance_);
}

void WindowLens::set_covariance(const Scalar* covariance, Scalar inflation) {
  for (int i = 0; i < rows_.count * rows_.count; ++i) covariance_[i] = inflation * covariance[i];
}

}  // namespace pf
