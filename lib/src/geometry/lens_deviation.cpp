#include "geometry/lens_deviation.h"

#include <algorithm>
#include <cmath>

namespace pf {

Scalar lens_deviation(const LensPrior& prior, const Camera& calibration, const Camera& now) {
  const Scalar moved[4] = {now.fx - calibration.fx, now.fy - calibration.fy, now.cx - calibration.cx,
                           now.cy - calibration.cy};
  Scalar largest = 0;
  for (int i = 0; i < prior.rows.count; ++i) {
    const int k = prior.rows.parameter[i];
    const Scalar by = k < 4 ? moved[k] : now.distortion[k - 4] - calibration.distortion[k - 4];
    largest = std::max(largest, std::abs(by) / std::sqrt(prior.covariance[i * (prior.rows.count + 1)]));
  }
  return largest;
}

}  // namespace pf
