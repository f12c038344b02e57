#pragma once

#include <cstdint>

#include "bed.h"

namespace pfsim {

/// What a frame costs at the end of a run.
struct UpdateCost {
  double update_us = 0;  ///< the filter's update alone, median
  double frame_us = 0;   ///< all of pf_push_observations, likewise
};

/// Processor time of this thread [ns]; for pf_config_t::clock_ns.
std::int64_t thread_clock(void*);

/// Goes on for some 60 frames, of which only 10 observations each are handed over (20 rows), evenly out of all that is seen. The
/// context must have thread_clock, and is not good for anything afterwards.
UpdateCost cost_of_20_rows(Bed& bed, pf_slam_t* slam, pf_pose_t pose, int frame, double rate_hz);

}  // namespace pfsim
