#pragma once

#include <string>

#include "innovations.h"
#include "run.h"

namespace pfsim {

struct RenderedOptions {
  std::string scene = "desk";
  pf_sim_options_t sim;   ///< the seed is set for each run
  pf_config_t config;     ///< the camera is taken from sim
  bool rectangle = true;  ///< the target finds itself; otherwise its corners, about a first pose from its prior
};

/// What one run gave besides its frames. Plain data, so that it may lie in memory shared between processes.
struct RenderedSummary {
  std::int32_t done = 0;
  std::int32_t lost_frames = 0;  ///< also those that were refused or have no valid covariance
  std::int32_t coasting_frames = 0, tracked_frames = 0, starting_frames = 0;
  InnovationSums innovations[kTrackKinds];
};

/// One run, start to end. rows has sim.frames entries; nees_position is negative in those without a pose.
RenderedSummary run_rendered(const RenderedOptions& options, std::uint64_t seed, FrameRow* rows);

}  // namespace pfsim
