#pragma once

#include <cstdint>
#include <vector>

#include "bed.h"
#include "update_cost.h"

namespace pfsim {

/// What one frame of one run gave.
struct FrameRow {
  float nees_position, nees_pose;  ///< negative: no valid covariance
  float error_m, sigma_m;          ///< of the position; sigma_m is the root of the trace
  float state_dim, inliers;
  float active_dim;            ///< rows that carry a gain
  float points_only_dim;       ///< what the same map would need unfolded
  float plane_points, planes;  ///< folded or fixed, and planes in the map
  float nis, nis_dof;
  float nees_motion;  ///< over the window that ends here, 6 dof; negative where none does
  float nees_motion_rotation, nees_motion_translation;  ///< likewise, 3 dof each
  float p_W[3], true_W[3];                              ///< where the camera is for the filter, and in truth [m]
};

/// A frame's pose against the truth, both in the truth's own frame: theta of R_true = Exp(theta) R, then p_true - p.
FrameRow judge(const pf::sim::Pose& truth, const pf_pose_t& pose, const pf_report_t& report);

/// What one run gave besides its frames. Plain data, so that it may lie in memory shared between processes.
struct RunSummary {
  std::int32_t done = 0;
  std::int32_t lost = 0;  ///< the state was lost, or the covariance was not valid, at any frame
  std::int32_t frames_tracked = 0;
  double gauge_pose_growth = 0;   ///< of the information about global translation and rotation since the first frame
  double gauge_scale_growth = 0;  ///< of that about scale, likewise; depth priors of new points are part of it
  double gauge_scale_beyond_priors =
      -1;  ///< likewise, less what the priors of 1/depth brought in: 1/relative_sigma^2 each
  double gauge_scale_step_growth = 0;  ///< in one frame without new points
  double map_square_sum = 0;           ///< of the distances between points of the map and the truth at the end [m^2]
  double map_count = 0;
  double map_nees_sum = 0;     ///< of the same points
  double folded_nees_sum = 0;  ///< of folded and fixed ones among them
  double folded_count = 0, fixed_count = 0;
  double plane_nees_sum = 0;  ///< (alpha, beta, delta) of the planes that are true, 3 dof
  std::int32_t planes_judged = 0;
  std::int32_t planes_true = 0, planes_mixed = 0, planes_false = 0, planes_duplicate = 0;  ///< at the end
  std::int32_t planes_ever = 0, planes_ever_true = 0, planes_ever_false = 0;  ///< judged when they had settled
  std::int32_t walls_seen = 0, walls_found = 0;
  double lens_nees = -1;     ///< of fx, fy, cx, cy, k1 at the end, 5 dof; negative where the lens is exact
  std::int32_t unsound = 0;  ///< readings at which P was not positive definite
  double cpu_seconds = 0;    ///< in pf_push_observations
  UpdateCost cost;           ///< after the last frame; zero without a clock
};

struct RunOptions {
  int gauge_every = 10;   ///< frames between readings of the gauge information, 0: never
  int motion_frames = 0;  ///< of a window over which the motion is judged, 0: none
};

/// One run, start to end. rows has as many entries as the bed has frames.
RunSummary run_once(const BedOptions& bed_options, const pf_config_t& config, const RunOptions& options,
                    std::uint64_t seed, FrameRow* rows);

/// Calls job(0 .. count-1) in that many processes at a time, with a progress line on stderr. What a job leaves behind
/// must lie in shared memory. False when a process died.
bool in_processes(int count, int processes, const char* title, void (*job)(int index, void* context), void* context);

/// Zeroed memory that child processes write and the parent reads; null when there is none. Lives until the program ends.
void* shared_memory(std::size_t bytes);

}  // namespace pfsim
