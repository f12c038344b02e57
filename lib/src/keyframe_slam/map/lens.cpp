#include "keyframe_slam/map/lens.h"

namespace pf {

void KeyframeLens::init(const Camera& calibration, const LensPrior& prior) {
  rows_ = prior.rows;
  prior_ = prior;
  camera_ = prior_camera_ = calibration;
  for (int a = 0; a < rows_.count; ++a)
    for (int b = 0; b < rows_.count; ++b) covariance_[a * rows_.count + b] = prior.covariance(a, b);
}

void KeyframeLens::set_covariance(const Scalar* covariance, Scalar inflation) {
  for (int i = 0; i < rows_.count * rows_.count; ++i) covariance_[i] = inflation * covariance[i];
}

void KeyframeLens::begin_readout(Scalar readout, Scalar variance) {
  if (!rows_.has_readout()) return;
  prior_camera_.readout = readout;
  prior_.variance[rows_.count - 1] = variance;
  covariance_[rows_.count * rows_.count - 1] = variance;
}

}  // namespace pf
