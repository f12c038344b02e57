#include "geometry/lens_deviation.h"

#include <algorithm>
#include <cmath>

namespace pf {

Scalar lens_deviation(const LensPrior& prior, const Camera& calibration, const Camera& now) {
  Scalar moved[kLensParameters], largest = 0;
  lens_difference(prior.rows, calibration, now, moved);
  for (int i = 0; i < prior.rows.count; ++i)
    largest = std::max(largest, std::abs(moved[i]) / std::sqrt(prior.variance[i]));
  return largest;
}

}  // namespace pf
