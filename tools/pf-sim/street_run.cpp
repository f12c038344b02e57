#include "street_run.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "context.h"
#include "plane_error.h"
#include "planefold_platform/sim.h"
#include "sim/random.h"
#include "sim/scene_street.h"

namespace pfsim {
namespace {

using pf::sim::Mat3;
using pf::sim::Pose;
using pf::sim::rotation_exp;
using pf::sim::Vec3;

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr double kExactSigma = 1e-6;  // [rad], [m]
constexpr double kSigmaSpeed = 0.1;   // of the first velocities [m/s], [rad/s]
constexpr double kMinTurn = 0.3;      // of a front's prior sigma: it was seen when less is left
constexpr std::size_t kMaxPlanes = 64;
constexpr int kJudgeEvery = 10;     // frames
constexpr double kOffFront = 0.05;  // [m]
constexpr double kOffFound = 5;     // [deg]

enum Stream : std::uint64_t { kPlanStream = 61, kStartStream };

Vec3 axis(const pf_wall_prior_t& wall, int k) { return {wall.R_WP[k], wall.R_WP[3 + k], wall.R_WP[6 + k]}; }

std::vector<pf_wall_prior_t> draw_plan(const StreetOptions& options, std::uint64_t seed) {
  pf::sim::Random plan(seed, kPlanStream);
  std::vector<pf_wall_prior_t> walls;
  for (int k = 0; k < pf::sim::kStreetFronts; ++k) {
    pf_wall_prior_t wall{};
    const double turn = options.sigma_rotation_deg * kDegree, lean = options.sigma_vertical_deg * kDegree;
    const Mat3 R = pf::sim::street_axes() * rotation_exp(Vec3{-lean * plan.normal(), turn * plan.normal(), 0});
    std::copy(R.m.begin(), R.m.end(), wall.R_WP);
    const Vec3 p = pf::sim::street_front(k) + axis(wall, 2) * (options.sigma_offset * plan.normal());
    const double at[3] = {p.x, p.y, p.z};
    std::copy(at, at + 3, wall.p_WP);
    wall.covariance[0] = turn * turn;
    wall.covariance[4] = lean * lean;
    wall.covariance[8] = options.sigma_offset * options.sigma_offset;
    const double a = 0.5 * pf::sim::kStreetFront, b = 0.5 * pf::sim::kStreetHigh;
    const double corner[4][2] = {{-a, -b}, {a, -b}, {a, b}, {-a, b}};
    wall.outline_count = 4;
    std::copy(&corner[0][0], &corner[0][0] + 8, &wall.outline_P[0][0]);
    walls.push_back(wall);
  }
  return walls;
}

Pose truth_at(const pf_sim_t* sim, double t) {
  pf_pose_t pose;
  pf_sim_pose_at(sim, std::llround(1e9 * t), &pose);
  return {pf::sim::rotation_of(pose.q_WC), {pose.p_WC[0], pose.p_WC[1], pose.p_WC[2]}};
}

pf_pose_t draw_start(const StreetOptions& options, const pf_sim_t* sim, std::uint64_t seed) {
  pf::sim::Random draw(seed, kStartStream);
  const Pose first = truth_at(sim, 0);
  const double theta = options.sigma_start_deg * kDegree;
  const Vec3 p = first.p_WC + draw.normal3() * options.sigma_start_m;
  pf_pose_t start{};
  const auto q = quaternion_of(rotation_exp(draw.normal3() * theta) * first.R_WC);
  std::copy(q.begin(), q.end(), start.q_WC);
  const Vec3 v = draw.normal3() * kSigmaSpeed, w = draw.normal3() * kSigmaSpeed;  // the walk begins at rest
  const double numbers[9] = {p.x, p.y, p.z, v.x, v.y, v.z, w.x, w.y, w.z};
  std::copy(numbers, numbers + 3, start.p_WC);
  std::copy(numbers + 3, numbers + 6, start.v_W);
  std::copy(numbers + 6, numbers + 9, start.w_C);
  for (int i = 0; i < 6; ++i) {
    const double sigma = i < 3 ? theta : options.sigma_start_m;
    start.covariance[7 * i] = sigma * sigma;
  }
  return start;
}

/// One context on its way through the frames.
class StreetRunner {
 public:
  StreetRunner(const StreetVariant& variant, const pf_pose_t& start, std::vector<pf_wall_prior_t> walls)
      : walls_(std::move(walls)), ids_(walls_.size()), ever_(walls_.size()), context_(variant.config) {
    double velocities[36] = {};
    for (int i = 0; i < 6; ++i) velocities[7 * i] = kSigmaSpeed * kSigmaSpeed;
    if (variant.plan == StreetPlan::kNone) {
      walls_.clear();
      ids_.clear();
    }
    if (variant.plan == StreetPlan::kExact)
      for (pf_wall_prior_t& wall : walls_)
        for (int i = 0; i < 9; i += 4) wall.covariance[i] = kExactSigma * kExactSigma;
    if (!context_.slam || pf_start_from_pose(context_.slam, &start, velocities) != PF_OK) return;
    for (std::size_t i = 0; i < walls_.size(); ++i)
      if (pf_add_wall(context_.slam, &walls_[i], &ids_[i]) != PF_OK) return;
    summary.done = 1;
  }

  void push(const pf_image_t& image, const Pose& truth, FrameRow& row) {
    const pf_status_t status = pf_push_frame(context_.slam, &image);
    summary.tracked_frames += status == PF_OK;
    summary.lost_frames += status == PF_NOTE_LOST;
    summary.end_m = summary.end_sigma_m = summary.end_nees = -1;
    pf_pose_t pose;
    pf_report_t report;
    if (status < 0 || pf_get_pose(context_.slam, &pose) != PF_OK) return;
    pf_get_report(context_.slam, &report);
    row = judge(truth, pose, report);
    summary.end_m = static_cast<double>(row.error_m);
    summary.end_sigma_m = static_cast<double>(row.sigma_m);
    summary.end_nees = static_cast<double>(row.nees_position);
    pf_patch_t patches[32];
    std::size_t count = 0;
    pf_get_patches(context_.slam, patches, 32, &count);
    for (std::size_t i = 0; i < count; ++i) summary.patches += patches[i].status == PF_MATCH_INLIER;
    note_doubts();
  }

  /// Whether the patches are on what they are taken to be on. surface, depth: as pf_sim_depth has them.
  void judge_patches(const pf_sim_t* sim, const pf_camera_t& camera, const Pose& truth, const std::vector<float>& depth,
                     const std::vector<std::int32_t>& surface) {
    pf_patch_t patches[32];
    pf_plane_t planes[kMaxPlanes];
    std::size_t count = 0, num_planes = 0;
    if (pf_get_patches(context_.slam, patches, 32, &count) < PF_OK ||
        pf_get_planes(context_.slam, planes, kMaxPlanes, &num_planes) < PF_OK)
      return;
    for (const pf_patch_t* patch = patches; patch != patches + std::min<std::size_t>(count, 32); ++patch) {
      if (patch->status != PF_MATCH_INLIER) continue;
      double px = 0, py = 0;
      for (const auto& corner : patch->corners_px) px += corner[0] / 4, py += corner[1] / 4;
      const int x = static_cast<int>(std::lround(px)), y = static_cast<int>(std::lround(py));
      if (x < 0 || y < 0 || x >= camera.width || y >= camera.height) continue;
      const std::size_t at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(x);
      double ray[3];
      const double pixel[2] = {static_cast<double>(x), static_cast<double>(y)};
      if (depth[at] <= 0 || pf_camera_unproject(&camera, pixel, ray) != PF_OK) continue;
      const Vec3 p =
          truth.p_WC + truth.R_WC * (Vec3{ray[0], ray[1], ray[2]} * (static_cast<double>(depth[at]) / ray[2]));
      if (std::find(ids_.begin(), ids_.end(), patch->plane) != ids_.end()) {
        ++summary.on_fronts;
        summary.off_fronts += std::fabs(p.z - pf::sim::kStreetFar) > kOffFront;
        continue;
      }
      for (const pf_plane_t* plane = planes; plane != planes + std::min(num_planes, kMaxPlanes); ++plane) {
        double n[3], d;
        if (plane->id != patch->plane || pf_sim_surface(sim, surface[at], n, &d) != PF_OK) continue;
        const Vec3 a{n[0], n[1], n[2]}, b{plane->normal_W[0], plane->normal_W[1], plane->normal_W[2]};
        ++summary.on_found;
        summary.off_found += std::atan2(a.cross(b).norm(), std::fabs(a.dot(b))) > kOffFound * kDegree;
      }
    }
  }

  void judge_walls() {
    pf_plane_t planes[kMaxPlanes];
    std::size_t count = 0;
    if (pf_get_planes(context_.slam, planes, kMaxPlanes, &count) < PF_OK) return;
    const Vec3 n = axis_of_truth();
    summary.doubted_ever = static_cast<std::int32_t>(std::count(ever_.begin(), ever_.end(), true));
    for (std::size_t i = 0; i < ids_.size(); ++i)
      for (const pf_plane_t* plane = planes; plane != planes + std::min(count, kMaxPlanes); ++plane) {
        if (plane->id != ids_[i]) continue;
        summary.doubted += plane->rejected != 0;
        if (plane->covariance[0] > kMinTurn * kMinTurn * walls_[i].covariance[0]) continue;  // never seen for long
        const Vec3 planned = axis(walls_[i], 2), c = pf::sim::street_front(static_cast<int>(i));
        const Vec3 now{plane->normal_W[0], plane->normal_W[1], plane->normal_W[2]};
        const Vec3 p{walls_[i].p_WP[0], walls_[i].p_WP[1], walls_[i].p_WP[2]};
        ++summary.walls;
        summary.plan_deg += std::atan2(planned.cross(n).norm(), planned.dot(n)) / kDegree;
        summary.plan_m += std::fabs(planned.dot(c - p));
        summary.end_deg += std::atan2(now.cross(n).norm(), now.dot(n)) / kDegree;
        summary.wall_end_m += std::fabs(now.dot(c) - plane->distance);
        summary.wall_nees += normalised_plane_error(*plane, n, n.dot(c));
      }
  }

  StreetSummary summary;

 private:
  static Vec3 axis_of_truth() {
    const Mat3 R = pf::sim::street_axes();
    return {R(0, 2), R(1, 2), R(2, 2)};
  }

  void note_doubts() {
    pf_plane_t planes[kMaxPlanes];
    std::size_t count = 0;
    if (ids_.empty() || pf_get_planes(context_.slam, planes, kMaxPlanes, &count) < PF_OK) return;
    for (std::size_t i = 0; i < ids_.size(); ++i)
      for (const pf_plane_t* plane = planes; plane != planes + std::min(count, kMaxPlanes); ++plane)
        if (plane->id == ids_[i] && plane->rejected != 0) ever_[i] = true;
  }

  std::vector<pf_wall_prior_t> walls_;
  std::vector<std::uint32_t> ids_;
  std::vector<bool> ever_;  ///< doubted in any frame
  Context context_;
};

}  // namespace

void run_street(const StreetOptions& options, const std::vector<StreetVariant>& variants, std::uint64_t seed,
                const std::vector<StreetSummary*>& summaries, const std::vector<FrameRow*>& rows) {
  for (FrameRow* of_variant : rows)
    for (int frame = 0; frame < options.frames; ++frame)
      of_variant[frame].nees_position = of_variant[frame].nees_pose = -1;
  pf_sim_options_t sim_options;
  pf_sim_options_default("street", &sim_options);
  sim_options.seed = seed;
  sim_options.frames = options.frames;
  sim_options.rate_hz = options.rate_hz;
  const std::unique_ptr<pf_sim_t, void (*)(pf_sim_t*)> sim(pf_sim_open("street", &sim_options), pf_sim_close);
  if (!sim) return;
  const std::vector<pf_wall_prior_t> plan = draw_plan(options, seed);
  const pf_pose_t start = draw_start(options, sim.get(), seed);
  std::vector<std::unique_ptr<StreetRunner>> runners;
  for (StreetVariant variant : variants) {
    pf_sim_camera(sim.get(), &variant.config.camera);
    runners.push_back(std::make_unique<StreetRunner>(variant, start, plan));
    if (runners.back()->summary.done == 0) return;
  }
  pf_image_t image;
  double path_m = 0;
  Pose before = truth_at(sim.get(), 0);
  pf_camera_t camera;
  pf_sim_camera(sim.get(), &camera);
  const std::size_t pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  std::vector<float> depth(pixels);
  std::vector<std::int32_t> surface(pixels);
  for (int frame = 0; frame < options.frames && pf_sim_next(sim.get(), &image, nullptr); ++frame) {
    const Pose truth = truth_at(sim.get(), frame / options.rate_hz);
    path_m += (truth.p_WC - before.p_WC).norm();
    before = truth;
    for (std::size_t v = 0; v < runners.size(); ++v) runners[v]->push(image, truth, rows[v][frame]);
    if (frame % kJudgeEvery != 0) continue;
    pf_pose_t pose;
    pf_sim_pose_at(sim.get(), image.t_ns, &pose);
    pf_sim_depth(sim.get(), &pose, depth.data(), surface.data());
    for (const auto& runner : runners) runner->judge_patches(sim.get(), camera, truth, depth, surface);
  }
  for (std::size_t v = 0; v < runners.size(); ++v) {
    runners[v]->judge_walls();
    runners[v]->summary.path_m = path_m;
    *summaries[v] = runners[v]->summary;
  }
}

}  // namespace pfsim
