#pragma once

#include "frame/noise_model.h"
#include "frame/settings.h"

namespace pf {

class Archive;

/// Logs what fits badly, once each: matches far beyond their noise, a lens far from its calibration.
class FitWarnings {
 public:
  /// lens: the present estimate.
  void check(const Settings& settings, const NoiseModel& noise, const Camera& lens);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  bool said_noise_ = false, said_lens_ = false;
};

}  // namespace pf
