#include "keyframe_slam/map/lens.h"

namespace pf {

void KeyframeLens::init(const Camera& calibration, const LensPrior& prior) {
  rows_ = prior.rows;
  camera_ = calibration;
  for (int a = 0; a < rows_.count; ++a)
    for (int b = 0; b < rows_.count; ++b) covariance_[a * rows_.count + b] = prior.covariance(a, b);
}

void KeyframeLens::set_covariance(const Scalar* covariance, Scalar inflation) {
  for (int i = 0; i < rows_.count * rows_.count; ++i) covariance_[i] = inflation * covariance[i];
}

}  // namespace pf
