#pragma once

#include "geometry/lens.h"

namespace pf {

/// Largest distance of an uncertain number of a lens from the calibration, in its prior standard deviations; 0 where none is uncertain.
Scalar lens_deviation(const LensPrior& prior, const Camera& calibration, const Camera& now);

/// The lens to begin with in a map that another lens has made: that one, where it can be that of the same camera, which is within
/// max_deviation of the calibration; the calibration where it cannot, or is exact.
Camera lens_of_map(const LensPrior& prior, const Camera& calibration, const Camera& of_map, Scalar max_deviation);

}  // namespace pf
