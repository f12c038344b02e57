#include "frame/fit_warnings.h"

#include "frame/tuning.h"
#include "geometry/lens_deviation.h"

namespace pf {

void FitWarnings::check(const Settings& settings, const NoiseModel& noise, const Camera& lens) {
  if (!said_noise_ && noise.is_implausible()) {
    said_noise_ = true;
    settings.hooks.say(
        "matches are 3 times as far off as their noise explains: check the calibration, the readout time and the "
        "timestamps");
  }
  if (!said_lens_ && lens_deviation(settings.lens, settings.camera, lens) > tuning::tracking::kMaxLensDeviation) {
    said_lens_ = true;
    settings.hooks.say(
        "the estimated lens is more than 3 sigma from the calibration: check the calibration, or give it larger "
        "sigmas");
  }
}

}  // namespace pf
