#pragma once

#include "box.h"
#include "run.h"

namespace pfsim {

/// What one run gave besides its frames. Plain data, so that it may lie in memory shared between processes.
struct BoxSummary {
  std::int32_t done = 0;
  std::int32_t tracked_frames = 0;
  std::int32_t walls = 0;  ///< judged: those that are where the plan has them, roughly
  double plan_deg[kBoxSides] = {},
         plan_m[kBoxSides] = {};  ///< errors of the plan: angle of the normal, and at the true centre
  double end_deg[kBoxSides] = {}, end_m[kBoxSides] = {};  ///< of the same walls at the end
  double end_nees[kBoxSides] = {};                        ///< likewise, 3 dof; negative: no valid covariance
  std::int32_t points[kBoxSides] = {};                    ///< on them at the end
  std::int32_t doubted = 0;                               ///< walls at the end, of those judged
  double wrong_seen_s = -1;       ///< how long the wrong wall was in view before it was doubted; -1: it was not
  std::int32_t wrong_points = 0;  ///< most points that ever were on it
  double worst_m = 0;             ///< largest position error
  std::int32_t lost_frames = 0;
  std::int32_t dark_frames = 0;                               ///< left out of all that is judged
  std::int32_t frames_to_find = 0;                            ///< with light behind the dark, until one is tracked
  std::int32_t missing = 0;                                   ///< sides that the plan does not have
  double found_deg[kBoxSides] = {}, found_m[kBoxSides] = {};  ///< of the best plane for each; negative: there is none
  std::int32_t patch_inliers = 0, patch_outliers = 0, patch_missed = 0;  ///< over all frames
  double patch_seconds = 0;
};

/// One run with one plan, start to end. rows has as many entries as the box has frames; nees_position is negative in those without a pose.
BoxSummary run_box(const BoxOptions& options, const pf_config_t& config, Plan plan, std::uint64_t seed, FrameRow* rows);

/// What runs on the same rendered frames as others.
struct BoxVariant {
  pf_config_t config;  ///< its camera is that of the frames
  Plan plan;
};

/// Rendered frames once, for all variants. summaries and rows: one for each of them.
void run_rendered_box(const BoxOptions& options, const std::vector<BoxVariant>& variants, std::uint64_t seed,
                      const std::vector<BoxSummary*>& summaries, const std::vector<FrameRow*>& rows);

}  // namespace pfsim
