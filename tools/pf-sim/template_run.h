#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "planefold_platform/sim.h"

namespace pfsim {

/// What is compared with what, on the same frames.
struct TemplateCase {
  std::string name;
  pf_config_t config;
};

struct TemplateOptions {
  std::string scene;
  pf_sim_options_t sim;      ///< the seed is set for each run
  int judge_after = 30;      ///< frames that a mask has learnt from
  double lost_error = 0.08;  ///< an error that is a loss [m]: a tenth of the depth
  std::string table;         ///< beginning of the names of CSV files, one for each case; empty: none
  std::string templates;     ///< CSV file for pixels and masks of straddling templates of the first case; empty: none
};

/// One run of one case. Plain data, so that it may lie in memory shared between processes.
struct TemplateSums {
  std::int32_t done = 0, lost = 0;  ///< lost: tracking ended, or the error is beyond lost_error
  std::int32_t frames = 0, tracked = 0;
  double tracks = 0, track_frames = 0,
         median_track = 0;              ///< features that were measured again, frames in which they were
  double inliers = 0;                   ///< with a depth, sum over frames
  double position2 = 0, rotation2 = 0;  ///< sums over frames with a pose [m^2], [rad^2]
  double begun = 0, straddling = 0;     ///< templates
  double judged = 0, mask = 0, all_on = 0, surface = 0, visible = 0;  ///< of straddling ones
  double area = 0, area_frames = 0;
};

/// All cases through one run. sums has an entry for each.
void run_templates(const TemplateOptions& options, const std::vector<TemplateCase>& cases, std::uint64_t seed,
                   TemplateSums* sums);

}  // namespace pfsim
