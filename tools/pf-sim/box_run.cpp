#include "box_run.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "context.h"
#include "gross_patches.h"
#include "plane_error.h"

namespace pfsim {
namespace {

using pf::sim::Vec3;

constexpr int kMaxPlanes = 64;
constexpr int kInView = 8;        // points that are seen through a wall's outline, for it to be in view
constexpr double kFoundDeg = 15;  // of a plane that may be a side
constexpr double kFoundM = 0.15;
constexpr double kDegrees = 57.29577951308232;

double angle_deg(const Vec3& a, const Vec3& b) { return kDegrees * std::atan2(a.cross(b).norm(), a.dot(b)); }

/// Plane of the map by its id; false: there is none.
bool find_plane(const pf_slam_t* slam, std::uint32_t id, pf_plane_t* plane) {
  pf_plane_t planes[kMaxPlanes];
  std::size_t count = 0;
  if (pf_get_planes(slam, planes, kMaxPlanes, &count) < PF_OK) return false;
  const pf_plane_t* end = planes + std::min<std::size_t>(count, kMaxPlanes);
  const pf_plane_t* found =
      std::find_if(planes, const_cast<pf_plane_t*>(end), [&](const pf_plane_t& p) { return p.id == id; });
  if (found == end) return false;
  *plane = *found;
  return true;
}

/// How long the wrong wall is in view until it is doubted.
class WrongWall {
 public:
  WrongWall(const Box& box, const pf_wall_prior_t* prior, std::uint32_t id, double rate_hz)
      : box_(box), prior_(prior), id_(id), rate_hz_(rate_hz) {}

  void look(const pf_slam_t* slam, int frame, BoxSummary& summary) {
    pf_plane_t plane;
    if (prior_ == nullptr || !find_plane(slam, id_, &plane)) return;
    summary.wrong_points = std::max(summary.wrong_points, plane.points);
    if (plane.rejected != 0 && summary.wrong_seen_s < 0) summary.wrong_seen_s = seen_ / rate_hz_;
    seen_ += box_.count_behind(*prior_, frame) >= kInView;
  }

 private:
  const Box& box_;
  const pf_wall_prior_t* prior_;
  std::uint32_t id_;
  double rate_hz_;
  int seen_ = 0;
};

/// Side of the box that a wall of the plan stands for.
int side_of(const pf_wall_prior_t& wall) {
  int best = 0;
  const Vec3 n{wall.R_WP[2], wall.R_WP[5], wall.R_WP[8]};
  for (int side = 1; side < kBoxSides; ++side)
    if (n.dot(Box::normal(side)) > n.dot(Box::normal(best))) best = side;
  return best;
}

void judge_wall(const pf_slam_t* slam, const pf_wall_prior_t& prior, std::uint32_t id, BoxSummary& summary) {
  const int side = side_of(prior), k = summary.walls++;
  const Vec3 n = Box::normal(side), c = Box::centre(side);
  const Vec3 planned{prior.R_WP[2], prior.R_WP[5], prior.R_WP[8]};
  const Vec3 o{prior.p_WP[0], prior.p_WP[1], prior.p_WP[2]};
  summary.plan_deg[k] = angle_deg(planned, n);
  summary.plan_m[k] = std::fabs(planned.dot(c - o));
  summary.end_nees[k] = -1;
  pf_plane_t plane;
  if (!find_plane(slam, id, &plane)) return;
  const Vec3 now{plane.normal_W[0], plane.normal_W[1], plane.normal_W[2]};
  summary.end_deg[k] = angle_deg(now, n);
  summary.end_m[k] = std::fabs(now.dot(c) - plane.distance);
  summary.end_nees[k] = normalised_plane_error(plane, n, n.dot(c));
  summary.points[k] = plane.points;
  summary.doubted += plane.rejected != 0;
}

/// The plane that was found of a side that the plan does not have: the nearest in angle.
void judge_missing(const pf_slam_t* slam, int side, BoxSummary& summary) {
  const int k = summary.missing++;
  const Vec3 n = Box::normal(side), c = Box::centre(side);
  summary.found_deg[k] = summary.found_m[k] = -1;
  pf_plane_t planes[kMaxPlanes];
  std::size_t count = 0;
  if (pf_get_planes(slam, planes, kMaxPlanes, &count) < PF_OK) return;
  for (const pf_plane_t* plane = planes; plane != planes + std::min<std::size_t>(count, kMaxPlanes); ++plane) {
    const Vec3 now{plane->normal_W[0], plane->normal_W[1], plane->normal_W[2]};
    const double angle = angle_deg(now, n), off = std::fabs(now.dot(c) - plane->distance);
    if (plane->is_wall != 0 || angle > kFoundDeg || off > kFoundM) continue;
    if (summary.found_deg[k] >= 0 && summary.found_deg[k] < angle) continue;
    summary.found_deg[k] = angle;
    summary.found_m[k] = off;
  }
}

/// One context on its way through the frames.
class BoxRunner {
 public:
  BoxRunner(Box& box, const pf_config_t& config, Plan plan, double rate_hz)
      : box_(box), plan_(plan), walls_(box.walls(plan)), ids_(walls_.size()), context_(config) {
    pf_slam_t* slam = context_.slam;
    if (!slam || pf_start_from_pose(slam, &box.start(), box.velocity_covariance()) != PF_OK) return;
    for (std::size_t i = 0; i < walls_.size(); ++i)
      if (pf_add_wall(slam, &walls_[i], &ids_[i]) != PF_OK) return;
    const int wrong = Box::wrong_wall(plan);
    const auto at = static_cast<std::size_t>(std::max(wrong, 0));
    watch_ = std::make_unique<WrongWall>(box, wrong < 0 ? nullptr : &walls_[at], wrong < 0 ? 0 : ids_[at], rate_hz);
    summary.done = 1;
  }

  pf_slam_t* slam() { return context_.slam; }

  /// dark: the frame was black, and is not judged.
  void look(pf_status_t status, int frame, bool dark, FrameRow& row) {
    pf_pose_t pose;
    pf_report_t report;
    if (dark) {
      ++summary.dark_frames;
      searching_ = true;
      return;
    }
    searching_ = searching_ && status != PF_OK;
    summary.frames_to_find += searching_;
    summary.lost_frames += status == PF_NOTE_LOST;
    if (status < 0 || pf_get_pose(slam(), &pose) != PF_OK) return;
    pf_get_report(slam(), &report);
    row = judge(box_.truth(frame), pose, report);
    summary.tracked_frames += status == PF_OK;
    summary.worst_m = std::max(summary.worst_m, static_cast<double>(row.error_m));
    summary.patch_seconds += 1e-9 * static_cast<double>(report.stage_ns[PF_STAGE_PATCH]);
    count_patches();
    watch_->look(slam(), frame, summary);
  }

  void judge_walls() {
    for (std::size_t i = 0; i < walls_.size(); ++i)
      if (static_cast<int>(i) != Box::wrong_wall(plan_)) judge_wall(slam(), walls_[i], ids_[i], summary);
    for (int side = 0; side < kBoxSides; ++side) {
      const bool known = std::any_of(walls_.begin(), walls_.end(), [&](const auto& w) { return side_of(w) == side; });
      if (!known) judge_missing(slam(), side, summary);
    }
  }

  BoxSummary summary;

 private:
  void count_patches() {
    constexpr int kMaxPatches = 32;
    pf_patch_t patches[kMaxPatches];
    std::size_t count = 0;
    pf_get_patches(slam(), patches, kMaxPatches, &count);
    for (std::size_t i = 0; i < count; ++i) {
      summary.patch_inliers += patches[i].status == PF_MATCH_INLIER;
      summary.patch_outliers += patches[i].status == PF_MATCH_OUTLIER;
      summary.patch_missed += patches[i].status == PF_MATCH_MISSED;
    }
  }

  Box& box_;
  Plan plan_;
  std::vector<pf_wall_prior_t> walls_;
  std::vector<std::uint32_t> ids_;
  Context context_;
  std::unique_ptr<WrongWall> watch_;
  bool searching_ = false;  ///< since the dark
};

void forget(FrameRow* rows, int frames) {
  for (int frame = 0; frame < frames; ++frame) rows[frame].nees_position = rows[frame].nees_pose = -1;
}

}  // namespace

BoxSummary run_box(const BoxOptions& options, const pf_config_t& config, Plan plan, std::uint64_t seed,
                   FrameRow* rows) {
  forget(rows, options.frames);
  Box box(options, config.camera, config.measurement.sigma_px, seed);
  BoxRunner runner(box, config, plan, options.rate_hz);
  if (runner.summary.done == 0) return runner.summary;
  for (int frame = 0; frame < options.frames; ++frame) {
    const auto seen = box.observe(frame);
    const auto t_ns = static_cast<std::int64_t>(std::llround(frame * 1e9 / options.rate_hz));
    runner.look(pf_push_observations(runner.slam(), t_ns, seen.data(), seen.size()), frame, false, rows[frame]);
  }
  runner.judge_walls();
  return runner.summary;
}

void run_rendered_box(const BoxOptions& options, const std::vector<BoxVariant>& variants, std::uint64_t seed,
                      const std::vector<BoxSummary*>& summaries, const std::vector<FrameRow*>& rows) {
  for (FrameRow* of_variant : rows) forget(of_variant, options.frames);
  pf_sim_options_t sim_options;
  pf_sim_options_default("box", &sim_options);
  sim_options.seed = seed;
  sim_options.frames = options.frames;
  sim_options.rate_hz = options.rate_hz;
  sim_options.shake_m = options.shake_m;
  sim_options.shake_rad = options.shake_rad;
  const std::unique_ptr<pf_sim_t, void (*)(pf_sim_t*)> sim(pf_sim_open("box", &sim_options), pf_sim_close);
  if (!sim) return;
  Box box(options, sim_options.camera, 0, seed, sim.get());
  std::vector<std::unique_ptr<BoxRunner>> runners;
  std::vector<GrossPatches> gross(variants.size(), GrossPatches(options.gross, seed));
  for (BoxVariant variant : variants) {
    pf_sim_camera(sim.get(), &variant.config.camera);
    runners.push_back(std::make_unique<BoxRunner>(box, variant.config, variant.plan, options.rate_hz));
    if (runners.back()->summary.done == 0) return;
  }
  pf_image_t image;
  for (int frame = 0; frame < options.frames && pf_sim_next(sim.get(), &image, nullptr); ++frame) {
    const double t = frame / options.rate_hz;
    const std::vector<std::uint8_t> black(static_cast<std::size_t>(image.stride) *
                                          static_cast<std::size_t>(image.height));
    const bool dark = t >= options.black_from_s && t < options.black_from_s + options.black_s;
    if (dark) image.pixels = black.data();
    for (std::size_t v = 0; v < runners.size(); ++v) {
      const pf_image_t seen = gross[v].spoil(runners[v]->slam(), image);
      runners[v]->look(pf_push_frame(runners[v]->slam(), &seen), frame, dark, rows[v][frame]);
    }
  }
  for (std::size_t v = 0; v < runners.size(); ++v) {
    runners[v]->judge_walls();
    *summaries[v] = runners[v]->summary;
  }
}

}  // namespace pfsim
