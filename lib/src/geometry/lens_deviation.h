#pragma once

#include "geometry/lens.h"

namespace pf {

/// Largest distance of an uncertain number of a lens from the calibration, in its prior standard deviations; 0 where none is uncertain.
Scalar lens_deviation(const LensPrior& prior, const Camera& calibration, const Camera& now);

}  // namespace pf
