#pragma once

#include "filter/filter.h"
#include "filter_slam/pose/pixel_update.h"
#include "frame/frame.h"
#include "frame/noise_model.h"
#include "map/map.h"
#include "track/tracker.h"

/// Noise with which a match in an image is gated and updates the filter, and learning it from residuals (lib/docs/theory/noise.md).

namespace pf {

class MatchNoise {
 public:
  MatchNoise(Filter& filter, Map& map, const Frame& frame, PixelUpdate& update, NoiseModel& model)
      : filter_(filter), map_(map), frame_(frame), update_(update), model_(model) {}

  /// Sets the noise of candidate i, which was found, and of its observation. parallax_lasts: the second-order error of baseline and open
  /// depth counts as one that stays with its feature.
  void set(int i, const SearchOutcome& found, bool parallax_lasts) const;
  Scalar correlation_frames() const { return model_.correlation_frames(); }
  /// Updates the noise model with the residuals of the inliers among the first `count` candidates, after the update.
  void learn(int count);

 private:
  bool is_averaged(const Feature& f) const;
  Mat2 update_noise(const Feature& f, const PixelMeasurement& o, const Mat2& noise, bool parallax_lasts) const;

  Filter& filter_;
  Map& map_;
  const Frame& frame_;
  PixelUpdate& update_;
  NoiseModel& model_;
};

}  // namespace pf
