#pragma once

#include <cstdint>
#include <vector>

#include "planefold/planefold.h"
#include "run.h"

/// A walk of 72 m along a street whose plan is coarse: every front is turned and shifted (lib/docs/theory/walls.md).

namespace pfsim {

enum class StreetPlan {
  kNone,     ///< points only
  kRefined,  ///< the fronts, with the standard deviations that their errors are drawn from
  kExact     ///< the same wrong fronts, as if they were exact (sigmas of 1e-6)
};

struct StreetOptions {
  int frames = 1800;
  double rate_hz = 30;
  double sigma_rotation_deg = 3, sigma_vertical_deg = 1, sigma_offset = 0.2;  ///< of a front in the plan
  double sigma_start_m = 0.01, sigma_start_deg = 0.2;                         ///< of the first pose
};

/// Plain data, so that it may lie in memory shared between processes.
struct StreetSummary {
  std::int32_t done = 0, tracked_frames = 0, lost_frames = 0;
  double end_m = -1, end_sigma_m = -1, end_nees = -1;  ///< of the last frame's position; negative: it had none
  double path_m = 0;
  std::int32_t walls = 0;
  std::int32_t doubted = 0, doubted_ever = 0;  ///< fronts: at the end, and in any frame
  double plan_deg = 0, plan_m = 0, end_deg = 0, wall_end_m = 0,
         wall_nees = 0;  ///< sums over fronts that patches or points lay on
  double patches = 0;    ///< measured, over all frames
  /// Patches that were measured in every tenth frame: on fronts, and on planes that were found; off: what the camera sees there is more
  /// than 5 cm from the front, or slanted against that plane by more than 5 degrees.
  std::int32_t on_fronts = 0, off_fronts = 0, on_found = 0, off_found = 0;
};

struct StreetVariant {
  pf_config_t config;  ///< its camera is that of the frames
  StreetPlan plan;
};

/// Rendered frames once, for all variants. summaries and rows: one for each of them.
void run_street(const StreetOptions& options, const std::vector<StreetVariant>& variants, std::uint64_t seed,
                const std::vector<StreetSummary*>& summaries, const std::vector<FrameRow*>& rows);

}  // namespace pfsim
