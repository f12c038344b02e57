#pragma once

#include <string>
#include <vector>

#include "fold_watch.h"
#include "innovations.h"
#include "rendered_planes.h"
#include "run.h"

namespace pfsim {

/// How a run on rendered frames begins. What is said of the target is always drawn about the truth with its own sigma_m.
enum class RenderedStart {
  kRectangle,  ///< the rectangle is found in the image; the pose comes from its corners
  kPoints,     ///< likewise its corners as points, about a first pose that is drawn from its prior
  kPose  ///< the points, and the pose drawn from its prior is the start: all that is known is true to its covariance
};

struct Variant {
  std::string lens = "right", masks = "none";  ///< for its label
  RenderedStart start = RenderedStart::kRectangle;
  pf_config_t config;
};

struct RenderedOptions {
  std::string scene = "desk";
  pf_sim_options_t sim;           ///< the seed is set for each run
  std::vector<Variant> variants;  ///< all see the same frames
  int motion_frames = 0;          ///< of a window over which the motion is judged, 0: none
  bool draw_lens =
      false;  ///< each run's true lens is drawn from the prior of sim.camera, which only the variant "right" is told
};

/// What one run gave besides its frames. Plain data, so that it may lie in memory shared between processes.
struct RenderedSummary {
  std::int32_t done = 0;
  std::int32_t lost_frames = 0;  ///< also those that were refused or have no valid covariance
  std::int32_t coasting_frames = 0, tracked_frames = 0, starting_frames = 0;
  InnovationSums innovations[kTrackKinds];
  double track_length = 0;  ///< InnovationWatch::track_length
  PlanesVerdict planes;     ///< at the end of the run
  FoldSums folds;
  double lens_error[5] = {},
         lens_sigma[5] = {};  ///< of fx, fy, cx, cy and k1 at the end; no sigma where the filter took them as exact
};

/// One run of every variant, start to end. summaries has an entry for each; rows[v] has sim.frames entries, and
/// nees_position is negative in those without a pose.
void run_rendered(const RenderedOptions& options, std::uint64_t seed, const std::vector<RenderedSummary*>& summaries,
                  const std::vector<FrameRow*>& rows);

}  // namespace pfsim
