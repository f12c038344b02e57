#include "box_run.h"

#include <algorithm>
#include <cmath>

#include "context.h"
#include "plane_error.h"

namespace pfsim {
namespace {

using pf::sim::Vec3;

constexpr int kMaxPlanes = 64;
constexpr int kInView = 8;  // points that are seen through a wall's outline, for it to be in view
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
  WrongWall(const Box& box, const pf_plane_prior_t* prior, std::uint32_t id, double rate_hz)
      : box_(box), prior_(prior), id_(id), rate_hz_(rate_hz) {}

  void look(const pf_slam_t* slam, int frame, BoxSummary& summary) {
    pf_plane_t plane;
    if (prior_ == nullptr || !find_plane(slam, id_, &plane)) return;
    summary.wrong_points = std::max(summary.wrong_points, plane.points);
    if (plane.doubted != 0 && summary.wrong_seen_s < 0) summary.wrong_seen_s = seen_ / rate_hz_;
    seen_ += box_.count_behind(*prior_, frame) >= kInView;
  }

 private:
  const Box& box_;
  const pf_plane_prior_t* prior_;
  std::uint32_t id_;
  double rate_hz_;
  int seen_ = 0;
};

/// Side of the box that a wall of the plan stands for.
int side_of(const pf_plane_prior_t& wall) {
  int best = 0;
  const Vec3 n{wall.R_WP[2], wall.R_WP[5], wall.R_WP[8]};
  for (int side = 1; side < kBoxSides; ++side)
    if (n.dot(Box::normal(side)) > n.dot(Box::normal(best))) best = side;
  return best;
}

void judge_wall(const pf_slam_t* slam, const pf_plane_prior_t& prior, std::uint32_t id, BoxSummary& summary) {
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
  summary.doubted += plane.doubted != 0;
}

}  // namespace

BoxSummary run_box(const BoxOptions& options, const pf_config_t& config, Plan plan, std::uint64_t seed,
                   FrameRow* rows) {
  BoxSummary summary;
  for (int frame = 0; frame < options.frames; ++frame) rows[frame].nees_position = rows[frame].nees_pose = -1;
  Box box(options, config.camera, config.measurement.sigma_px, seed);
  const std::vector<pf_plane_prior_t> walls = box.walls(plan);
  std::vector<std::uint32_t> ids(walls.size());
  const Context context(config);
  pf_slam_t* slam = context.slam;
  if (!slam || pf_start_from_pose(slam, &box.start(), box.velocity_covariance()) != PF_OK) return summary;
  for (std::size_t i = 0; i < walls.size(); ++i)
    if (pf_add_plane_prior(slam, &walls[i], &ids[i]) != PF_OK) return summary;
  const int wrong = Box::wrong_wall(plan);
  const auto at = static_cast<std::size_t>(std::max(wrong, 0));
  WrongWall watch(box, wrong < 0 ? nullptr : &walls[at], wrong < 0 ? 0 : ids[at], options.rate_hz);
  summary.done = 1;
  for (int frame = 0; frame < options.frames; ++frame) {
    const auto seen = box.observe(frame);
    const auto t_ns = static_cast<std::int64_t>(std::llround(frame * 1e9 / options.rate_hz));
    const pf_status_t status = pf_push_observations(slam, t_ns, seen.data(), seen.size());
    pf_pose_t pose;
    pf_report_t report;
    if (status < 0 || pf_get_pose(slam, &pose) != PF_OK) continue;
    pf_get_report(slam, &report);
    rows[frame] = judge(box.truth(frame), pose, report);
    summary.tracked_frames += status == PF_OK;
    summary.worst_m = std::max(summary.worst_m, static_cast<double>(rows[frame].error_m));
    watch.look(slam, frame, summary);
  }
  for (std::size_t i = 0; i < walls.size(); ++i)
    if (static_cast<int>(i) != wrong) judge_wall(slam, walls[i], ids[i], summary);
  return summary;
}

}  // namespace pfsim
