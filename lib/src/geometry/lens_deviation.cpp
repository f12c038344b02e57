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

Camera lens_of_map(const LensPrior& prior, const Camera& calibration, const Camera& of_map, Scalar max_deviation) {
  if (of_map.model != calibration.model || of_map.width != calibration.width || of_map.height != calibration.height)
    return calibration;
  Camera lens = of_map;
  lens.readout = calibration.readout;  // no map has one
  if (!(lens_deviation(prior, calibration, lens) <= max_deviation)) return calibration;
  Scalar moved[kLensParameters];
  lens_difference(prior.rows, calibration, lens, moved);
  lens = calibration;
  move_lens(prior.rows, moved, &lens);
  return lens;
}

}  // namespace pf
