#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "filter/inertial_motion.h"
#include "filter/moving_start.h"
#include "filter_slam/start/filter_start.h"
#include "frame/settings.h"
#include "frame/tracking_state.h"
#include "map/map.h"

/// Starts metric scale, gravity and the unit's biases from a camera at rest, or from one that moves (lib/docs/theory/inertial.md).

namespace pf {

class Archive;

class MetricStart {
 public:
  MetricStart(const Settings& settings, Filter& filter, Map& map, TrackingState& tracking, FilterStart& start)
      : settings_(settings), filter_(filter), map_(map), tracking_(tracking), start_(start) {}

  void init() { is_from_motion_ = false; }

  /// Whether lengths are in metres by the samples of a moving camera.
  bool is_from_motion() const { return is_from_motion_; }
  /// The camera has been at rest since begin_ns. True the first time that samples give the scale from here on: gravity and biases are then
  /// known, and a map whose scale is unknown begins anew with this frame.
  bool use_rest(const RestReading& rest, std::int64_t begin_ns);
  /// The same for a camera that moves: the map goes on in metres, under another id.
  void use_motion(const MovingSolution& solution);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  TrackingState& tracking_;
  FilterStart& start_;
  bool is_from_motion_ = false;  ///< kept between frames
};

}  // namespace pf
