#include "rendered_run.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "context.h"
#include "motion_watch.h"
#include "sim/random.h"

namespace pfsim {
namespace {

using pf::sim::Pose;
using pf::sim::Vec3;

constexpr std::uint64_t kStartStream = 21, kLensStream = 22;
constexpr int kLookEvery = 5;                          // frames between looks at what is in view
constexpr double kStartSpeed = 0.1, kStartRate = 0.1;  // about the truth's velocities [m/s], [rad/s]

struct CloseSim {
  void operator()(pf_sim_t* sim) const { pf_sim_close(sim); }
};

Pose pose_of(const pf_pose_t& p) { return {pf::sim::rotation_of(p.q_WC), {p.p_WC[0], p.p_WC[1], p.p_WC[2]}}; }

/// Moves a pose away from the truth by a draw from its covariance, which is diagonal, and its velocities likewise.
void draw_pose(pf_pose_t& pose, pf::sim::Random& random) {
  double e[6];
  for (int k = 0; k < 6; ++k) e[k] = std::sqrt(pose.covariance[7 * k]) * random.normal();
  const auto q = quaternion_of(pf::sim::rotation_exp(-Vec3{e[0], e[1], e[2]}) * pose_of(pose).R_WC);
  std::copy(q.begin(), q.end(), pose.q_WC);
  for (int k = 0; k < 3; ++k) {
    pose.p_WC[k] -= e[3 + k];
    pose.v_W[k] -= kStartSpeed * random.normal();
    pose.w_C[k] -= kStartRate * random.normal();
  }
}

/// A camera whose calibration is the prior's mean: its focal lengths, centre and k1 are drawn about that.
pf_camera_t draw_lens(const pf_camera_t& prior, std::uint64_t seed) {
  pf::sim::Random random(seed, kLensStream);
  pf_camera_t camera = prior;
  const double focal = prior.sigma_focal * random.normal(), aspect = prior.sigma_aspect * random.normal();
  camera.model = PF_CAMERA_RADTAN;
  camera.fx *= 1 + focal + aspect / 2;
  camera.fy *= 1 + focal - aspect / 2;
  camera.cx += prior.sigma_centre_px * random.normal();
  camera.cy += prior.sigma_centre_px * random.normal();
  camera.distortion[0] += prior.sigma_distortion[0] * random.normal();
  return camera;
}

/// The target as somebody would have measured it.
void draw_target(pf_target_t& target, pf::sim::Random& random) {
  target.width += std::sqrt(2.0) * target.sigma * random.normal();
  target.height += std::sqrt(2.0) * target.sigma * random.normal();
  for (int i = 0; i < target.count; ++i)
    for (double& x : target.points_W[i]) x += target.sigma * random.normal();
}

bool start(pf_slam_t* slam, RenderedStart how, const pf_sim_t* sim, std::uint64_t seed) {
  pf_target_t target;
  const bool rectangle = how == RenderedStart::kRectangle;
  if (pf_sim_target(sim, rectangle ? PF_TARGET_RECTANGLE : PF_TARGET_POINTS, &target) != PF_OK) return false;
  pf::sim::Random random(seed, kStartStream);
  draw_target(target, random);
  if (!rectangle) draw_pose(target.first_pose, random);
  if (pf_start_from_target(slam, &target) != PF_OK) return false;
  if (how != RenderedStart::kPose) return true;
  double velocity_covariance[36] = {};
  for (int k = 0; k < 6; ++k) velocity_covariance[7 * k] = k < 3 ? kStartSpeed * kStartSpeed : kStartRate * kStartRate;
  return pf_start_from_pose(slam, &target.first_pose, velocity_covariance) == PF_OK;
}

/// One context on its way through the frames.
struct Runner {
  Runner(const pf_sim_t* sim, const pf_config_t& config, const pf_target_t& corners, int motion_frames)
      : context(config), watch(config, corners), folds(sim, config), motion(motion_frames) {}
  Context context;
  InnovationWatch watch;
  FoldWatch folds;
  MotionWatch motion;

  void push(const pf_image_t& image, const pf_pose_t& truth, FrameDepth& depth, FrameRow& row, RenderedSummary& sums) {
    const pf_status_t status = pf_push_frame(context.slam, &image);
    pf_pose_t pose;
    if (pf_get_pose(context.slam, &pose) != PF_OK) {
      ++sums.starting_frames;
      sums.lost_frames += status < 0;
      return;
    }
    pf_report_t report;
    pf_get_report(context.slam, &report);
    row = judge(pose_of(truth), pose, report);
    motion.look(context.slam, status, pose_of(truth), row);
    const bool usable = status >= 0 && status != PF_NOTE_LOST && row.nees_position >= 0;
    sums.lost_frames += !usable;
    sums.tracked_frames += status == PF_OK;
    sums.coasting_frames += status == PF_NOTE_COASTING || status == PF_NOTE_UNUSABLE;
    watch.read(context.slam, truth, depth);
    folds.read(context.slam, truth, depth);
  }
};

void read_lens(const pf_slam_t* slam, const pf_camera_t& truth, RenderedSummary* summary) {
  pf_camera_t camera{};
  double covariance[100];
  if (pf_get_camera(slam, &camera, covariance) != PF_OK) return;
  const double known[5] = {camera.fx, camera.fy, camera.cx, camera.cy, camera.distortion[0]};
  const double right[5] = {truth.fx, truth.fy, truth.cx, truth.cy, truth.distortion[0]};
  for (int i = 0; i < 5; ++i) {
    summary->lens_error[i] = known[i] - right[i];
    summary->lens_sigma[i] = std::sqrt(covariance[11 * i]);
  }
}

}  // namespace

void run_rendered(const RenderedOptions& options, std::uint64_t seed, const std::vector<RenderedSummary*>& summaries,
                  const std::vector<FrameRow*>& rows) {
  for (FrameRow* of_variant : rows)
    for (int f = 0; f < options.sim.frames; ++f)
      of_variant[f].nees_position = of_variant[f].nees_pose = of_variant[f].nees_motion = -1;
  pf_sim_options_t sim_options = options.sim;
  sim_options.seed = seed;
  if (options.draw_lens) sim_options.camera = draw_lens(sim_options.camera, seed);
  const std::unique_ptr<pf_sim_t, CloseSim> sim(pf_sim_open(options.scene.c_str(), &sim_options));
  pf_target_t corners;
  if (!sim || pf_sim_target(sim.get(), PF_TARGET_POINTS, &corners) != PF_OK) return;

  FrameDepth depth(sim.get(), sim_options.camera);
  SurfaceWatch surfaces(sim.get(), sim_options.camera);
  std::vector<std::unique_ptr<Runner>> runners;
  for (Variant variant : options.variants) {
    if (options.draw_lens && variant.lens == "right") variant.config.camera = sim_options.camera;
    runners.push_back(std::make_unique<Runner>(sim.get(), variant.config, corners, options.motion_frames));
    pf_slam_t* slam = runners.back()->context.slam;
    if (!slam || !start(slam, variant.start, sim.get(), seed)) return;
  }
  pf_image_t image;
  pf_pose_t truth;
  for (int frame = 0; frame < sim_options.frames && pf_sim_next(sim.get(), &image, &truth); ++frame) {
    if (frame % kLookEvery == 0) surfaces.look(truth, kLookEvery / sim_options.rate_hz);
    for (std::size_t v = 0; v < runners.size(); ++v)
      runners[v]->push(image, truth, depth, rows[v][frame], *summaries[v]);
  }
  for (std::size_t v = 0; v < runners.size(); ++v) {
    for (int k = 0; k < kTrackKinds; ++k)
      summaries[v]->innovations[k] = runners[v]->watch.sums(static_cast<TrackKind>(k));
    summaries[v]->track_length = runners[v]->watch.track_length();
    summaries[v]->folds = runners[v]->folds.sums();
    read_lens(runners[v]->context.slam, sim_options.camera, summaries[v]);
    summaries[v]->planes = surfaces.judge(runners[v]->context.slam);
    summaries[v]->done = 1;
  }
}

}  // namespace pfsim
