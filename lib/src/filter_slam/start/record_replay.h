#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "filter_slam/pose/pixel_update.h"
#include "frame/settings.h"
#include "frame/start/start_without_target.h"
#include "inertial/body_motion.h"
#include "map/map.h"

/// Repeats the recorded frames of a start in the filter, which begins at the record's first frame.

namespace pf {

/// Every linearisation is at the bundle's poses, and residuals are zero: that moves no mean, and leaves the covariance that the recorded
/// pixels support. Points of a target are left out, since the record's unit of length is only as good as the bundle's depths of them.
class RecordReplay {
 public:
  /// update: for its scratch. unit: W's lengths per length of the record.
  RecordReplay(const Settings& settings, const BodyMotion& motion, const Map& map, const StartWithoutTarget& record,
               Scalar unit, Filter& filter, PixelUpdate& update)
      : settings_(settings),
        motion_(motion),
        map_(map),
        record_(record),
        unit_(unit),
        filter_(filter),
        update_(update) {}

  /// Predicts to each frame of the record, and updates with its pixels.
  void run();
  /// Sets the velocities from the last few frames of the record; several, because single poses are noisy.
  void set_velocities();

 private:
  void predict_to(const StartRecord::Frame& frame, std::int64_t before_ns);
  void update_with(int k);

  const Settings& settings_;
  const BodyMotion& motion_;
  const Map& map_;
  const StartWithoutTarget& record_;
  const Scalar unit_;
  Filter& filter_;
  PixelUpdate& update_;
};

}  // namespace pf
