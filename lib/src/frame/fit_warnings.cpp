#include "frame/fit_warnings.h"

#include "frame/tuning.h"
#include "geometry/lens_deviation.h"

namespace pf {

void FitWarnings::check(const Settings& settings, const NoiseModel& noise, const Camera& lens) {
  if (!said_noise_ && noise.is_implausible()) {
    said_noise_ = true;
    settings.hooks.say("matches scatter by ", fixed(noise.sigma_gate(), 2), " px, ", fixed(noise.scale(), 1),
                       " times what their noise explains: check the calibration, the readout time and the timestamps");
  }
  if (said_lens_) return;
  const Scalar deviation = lens_deviation(settings.lens, settings.camera, lens);
  if (deviation > tuning::tracking::kMaxLensDeviation) {
    said_lens_ = true;
    settings.hooks.say("the estimated lens is ", fixed(deviation, 1), " sigma from the calibration, fx ",
                       fixed(lens.fx, 1), " in place of ", fixed(settings.camera.fx, 1),
                       " px: check the calibration, or give it larger sigmas");
  }
}

}  // namespace pf
