#include "rendered_run.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "context.h"
#include "sim/random.h"

namespace pfsim {
namespace {

using pf::sim::Pose;
using pf::sim::Vec3;

constexpr std::uint64_t kStartStream = 21;

struct CloseSim {
  void operator()(pf_sim_t* sim) const { pf_sim_close(sim); }
};

Pose pose_of(const pf_pose_t& p) { return {pf::sim::rotation_of(p.q_WC), {p.p_WC[0], p.p_WC[1], p.p_WC[2]}}; }

/// Moves the first pose away from the truth by a draw from its own covariance, which is diagonal.
void draw_first_pose(pf_target_t& target, std::uint64_t seed) {
  pf::sim::Random random(seed, kStartStream);
  pf_pose_t& first = target.first_pose;
  double e[6];
  for (int k = 0; k < 6; ++k) e[k] = std::sqrt(first.covariance[7 * k]) * random.normal();
  const auto q = quaternion_of(pf::sim::rotation_exp(-Vec3{e[0], e[1], e[2]}) * pose_of(first).R_WC);
  std::copy(q.begin(), q.end(), first.q_WC);
  for (int k = 0; k < 3; ++k) first.p_WC[k] -= e[3 + k];
}

}  // namespace

RenderedSummary run_rendered(const RenderedOptions& options, std::uint64_t seed, FrameRow* rows) {
  RenderedSummary summary;
  for (int f = 0; f < options.sim.frames; ++f) rows[f].nees_position = rows[f].nees_pose = -1;
  pf_sim_options_t sim_options = options.sim;
  sim_options.seed = seed;
  const std::unique_ptr<pf_sim_t, CloseSim> sim(pf_sim_open(options.scene.c_str(), &sim_options));
  if (!sim) return summary;
  pf_config_t config = options.config;
  pf_sim_camera(sim.get(), &config.camera);
  const Context context(config);
  pf_target_t target, points;
  if (!context.slam || pf_sim_target(sim.get(), PF_TARGET_RECTANGLE, &target) != PF_OK ||
      pf_sim_target(sim.get(), PF_TARGET_POINTS, &points) != PF_OK)
    return summary;
  InnovationWatch watch(sim.get(), config, points);
  if (!options.rectangle) {
    target = points;
    draw_first_pose(target, seed);
  }
  if (pf_start_from_target(context.slam, &target) != PF_OK) return summary;

  pf_image_t image;
  pf_pose_t truth, pose;
  pf_report_t report;
  for (int frame = 0; frame < sim_options.frames && pf_sim_next(sim.get(), &image, &truth); ++frame) {
    const pf_status_t status = pf_push_frame(context.slam, &image);
    if (pf_get_pose(context.slam, &pose) != PF_OK) {
      ++summary.starting_frames;
      summary.lost_frames += status < 0;
      continue;
    }
    pf_get_report(context.slam, &report);
    rows[frame] = judge(pose_of(truth), pose, report);
    const bool usable = status >= 0 && status != PF_NOTE_LOST && rows[frame].nees_position >= 0;
    summary.lost_frames += !usable;
    summary.tracked_frames += status == PF_OK;
    summary.coasting_frames += status == PF_NOTE_COASTING || status == PF_NOTE_UNUSABLE;
    watch.read(context.slam, truth);
  }
  for (int k = 0; k < kTrackKinds; ++k) summary.innovations[k] = watch.sums(static_cast<TrackKind>(k));
  summary.done = 1;
  return summary;
}

}  // namespace pfsim
