#pragma once

#include <cstdint>
#include <string>

#include "slam.h"

namespace pfsim::gee {

/// What one frame of one run gave; state_dim is 0 after a run broke off.
struct PaperRow {
  float state_dim, nees_position, nees_pose;  ///< nees negative: the covariance is not positive
  float camera_square, map_square;            ///< squared errors [m^2]; that of the map is the mean of its points
  float inverse_depths, points, planar, fixed, planes, measured;
};

/// Where the pictures of Figure 1 are taken.
struct Moments {
  int before, after, end;  ///< frames: before the start comes into view again, after it, and the last
};

struct PaperSummary {
  std::int32_t done = 0;
  std::int32_t planes_true = 0, planes_false = 0, planes_duplicate = 0, planes_unused = 0;
  double map_square = 0;      ///< mean over the points of the map at the end [m^2]
  double wall_share_sum = 0;  ///< over planes: share of the points that lie on the plane's most frequent wall
  double cpu_seconds = 0;
};

/// The letters A to F as section 4 of the paper has them; false for others.
bool choose_case(char letter, SlamOptions* options);

Moments moments_of(int frames, int frames_per_loop);

/// One run, start to end; rows has as many entries as there are frames. Figure 1's tables are written under
/// figure_prefix unless it is empty.
PaperSummary run_paper(const WorldOptions& world_options, const SlamOptions& slam_options, std::uint64_t seed,
                       const std::string& figure_prefix, PaperRow* rows);

}  // namespace pfsim::gee
