#include "run.h"

#include <planefold/planefold_research.h>

#include <algorithm>
#include <cmath>

#include "context.h"
#include "motion_watch.h"
#include "statistics.h"
#include "wall_watch.h"

namespace pfsim {
namespace {

using pf::sim::rotation_log;
using pf::sim::rotation_of;
using pf::sim::Vec3;

double cpu_now() { return 1e-9 * static_cast<double>(thread_clock(nullptr)); }

/// Watches the information about what a camera cannot observe.
class GaugeWatch {
 public:
  void read(const pf_slam_t* slam, int state_dim) {
    before_valid_ = now_valid_;
    std::copy(now_, now_ + 49, before_);
    const auto n = static_cast<std::size_t>(state_dim);
    if (scratch_.size() < n * (n + 8)) scratch_.resize(n * (n + 8));
    now_valid_ = pf_get_gauge_information(slam, scratch_.data(), scratch_.size(), now_) == PF_OK;
    unsound_ += !now_valid_;
  }
  int unsound() const { return unsound_; }
  void keep_as_first() { std::copy(now_, now_ + 49, first_); }
  void compare(bool births, double from_priors, RunSummary& summary) const {
    if (!now_valid_) return;
    summary.gauge_pose_growth = std::max(summary.gauge_pose_growth, largest_ratio(first_, now_, 6, 7) - 1);
    summary.gauge_scale_growth = std::max(summary.gauge_scale_growth, now_[48] / first_[48] - 1);
    summary.gauge_scale_beyond_priors =
        std::max(summary.gauge_scale_beyond_priors, (now_[48] - from_priors) / first_[48] - 1);
    if (!births && before_valid_)
      summary.gauge_scale_step_growth = std::max(summary.gauge_scale_step_growth, now_[48] / before_[48] - 1);
  }

 private:
  std::vector<double> scratch_;
  double first_[49] = {}, before_[49] = {}, now_[49] = {};
  bool before_valid_ = false, now_valid_ = false;
  int unsound_ = 0;
};

std::vector<pf_feature_t> map_of(const pf_slam_t* slam, const pf_config_t& config) {
  std::vector<pf_feature_t> features(static_cast<std::size_t>(config.capacity.max_features));
  std::size_t count = 0;
  pf_get_features(slam, features.data(), features.size(), &count);
  features.resize(std::min(count, features.size()));
  return features;
}

/// Points that were offered and are not in the map are offered no more: their depth would no longer be a fresh draw.
void retire_what_is_gone(Bed& bed, const std::vector<pf_feature_t>& map) {
  std::vector<bool> there(bed.points().size(), false);
  for (const pf_feature_t& f : map)
    if (f.external_id < there.size()) there[f.external_id] = true;
  for (std::size_t id = 0; id < there.size(); ++id)
    if (bed.points()[id].begun && !there[id]) bed.retire(static_cast<std::uint32_t>(id));
}

void judge_map(const Bed& bed, const std::vector<pf_feature_t>& map, RunSummary& summary) {
  for (const pf_feature_t& f : map) {
    if (f.kind == PF_FEATURE_INVERSE_DEPTH || f.is_target || f.external_id >= bed.points().size()) continue;
    const Vec3 e = bed.points()[f.external_id].p_W - Vec3{f.p_W[0], f.p_W[1], f.p_W[2]};
    const double error[3] = {e.x, e.y, e.z};
    summary.map_square_sum += e.dot(e);
    const bool planar = f.kind != PF_FEATURE_POINT;
    summary.fixed_count += f.kind == PF_FEATURE_FIXED;
    // A folded point's covariance has what the filter knows of its plane; across it there may be next to nothing left.
    double covariance[9];
    std::copy(f.covariance, f.covariance + 9, covariance);
    for (int i = 0; i < 9 && planar; i += 4) covariance[i] += 1e-8;
    const double nees = normalised_error(error, covariance, 3, 3, 0);
    summary.map_nees_sum += nees;
    summary.map_count += 1;
    if (planar) {
      summary.folded_nees_sum += nees;
      summary.folded_count += 1;
    }
  }
}

/// Of the calibration as it is known now; negative where it is exact.
double judge_lens(const pf_slam_t* slam, const pf_camera_t& truth) {
  constexpr int kRows = 5;
  pf_camera_t camera;
  double covariance[100];
  if (pf_get_camera(slam, &camera, covariance) != PF_OK || !(covariance[0] > 0)) return -1;
  const double error[kRows] = {truth.fx - camera.fx, truth.fy - camera.fy, truth.cx - camera.cx, truth.cy - camera.cy,
                               truth.distortion[0] - camera.distortion[0]};
  return normalised_error(error, covariance, kRows, 10, 0);
}

}  // namespace

FrameRow judge(const pf::sim::Pose& truth, const pf_pose_t& pose, const pf_report_t& report) {
  FrameRow row{};
  const Vec3 theta = rotation_log(truth.R_WC * rotation_of(pose.q_WC).transposed());
  const Vec3 p{pose.p_WC[0], pose.p_WC[1], pose.p_WC[2]};
  const Vec3 e = truth.p_WC - p;
  const double error[6] = {theta.x, theta.y, theta.z, e.x, e.y, e.z};
  row.nees_position = static_cast<float>(normalised_error(error + 3, pose.covariance, 3, 6, 3));
  row.nees_pose = static_cast<float>(normalised_error(error, pose.covariance, 6, 6, 0));
  row.error_m = static_cast<float>(e.norm());
  row.sigma_m = static_cast<float>(std::sqrt(pose.covariance[21] + pose.covariance[28] + pose.covariance[35]));
  row.state_dim = static_cast<float>(report.state_dim);
  row.active_dim = static_cast<float>(report.state_dim - report.state_dim_held);
  row.points_only_dim = static_cast<float>(report.state_dim_points_only);
  row.plane_points = static_cast<float>(report.features_folded + report.features_fixed + report.features_trial);
  row.planes = static_cast<float>(report.planes);
  row.inliers = static_cast<float>(report.inliers);
  row.nis = static_cast<float>(report.nis);
  row.nis_dof = static_cast<float>(report.nis_dof);
  for (int i = 0; i < 3; ++i) row.p_W[i] = static_cast<float>(pose.p_WC[i]);
  row.true_W[0] = static_cast<float>(truth.p_WC.x);
  row.true_W[1] = static_cast<float>(truth.p_WC.y);
  row.true_W[2] = static_cast<float>(truth.p_WC.z);
  row.nees_motion = row.nees_motion_rotation = row.nees_motion_translation = -1;
  return row;
}

RunSummary run_once(const BedOptions& bed_options, const pf_config_t& config, const RunOptions& options,
                    std::uint64_t seed, FrameRow* rows) {
  RunSummary summary;
  summary.done = 1;
  summary.lost = 1;
  Bed bed(bed_options, config, seed);
  const Context context(config);
  pf_slam_t* slam = context.slam;
  if (!slam || pf_start_from_target(slam, &bed.target()) != PF_OK ||
      pf_start_from_pose(slam, &bed.start(), bed.velocity_covariance()) != PF_OK)
    return summary;
  summary.lost = 0;

  GaugeWatch gauge;
  WallWatch walls(bed);
  MotionWatch motion(options.motion_frames);
  double from_priors = 0;  // information about scale that new points came with
  pf_pose_t pose = bed.start();
  pf_report_t report{};
  for (int frame = 0; frame < bed_options.frames; ++frame) {
    if (frame > 0) {
      double dv_C[3], dw_C[3];
      bed.steer(frame - 1, pose, dv_C, dw_C);
      if (config.motion.model == PF_MOTION_CONSTANT_VELOCITY) pf_push_control(slam, dv_C, dw_C);
      bed.move(frame, dv_C, dw_C);
    }
    int births = 0;
    const auto seen = bed.observe(frame, &births);
    const double begin = cpu_now();
    const auto t_ns = static_cast<std::int64_t>(std::llround(frame * 1e9 / bed_options.rate_hz));
    const pf_status_t status = pf_push_observations(slam, t_ns, seen.data(), seen.size());
    summary.cpu_seconds += cpu_now() - begin;
    if (status < 0 || pf_get_pose(slam, &pose) != PF_OK) {
      summary.lost = 1;
      for (int rest = frame; rest < bed_options.frames; ++rest) rows[rest].nees_position = rows[rest].nees_pose = -1;
      return summary;
    }
    pf_get_report(slam, &report);
    from_priors += report.new_features / (config.first_depth.relative_sigma * config.first_depth.relative_sigma);
    rows[frame] = judge(bed.truth().pose, pose, report);
    motion.look(slam, status, bed.truth().pose, rows[frame]);
    summary.lost |= status == PF_NOTE_LOST || !(rows[frame].nees_position >= 0);
    summary.frames_tracked += status == PF_OK;
    if (bed_options.layout == Layout::kModel && (births > 0 || frame % 10 == 9))
      retire_what_is_gone(bed, map_of(slam, config));
    if (config.plane.enabled && frame % 10 == 9) walls.look(slam, map_of(slam, config));

    const int phase = options.gauge_every > 0 ? frame % options.gauge_every : -1;
    if (frame == 0 && options.gauge_every > 0) {
      gauge.read(slam, report.state_dim);
      gauge.keep_as_first();
    } else if (phase >= 0 && phase == options.gauge_every - 1) {
      gauge.read(slam, report.state_dim);
      gauge.compare(true, from_priors, summary);
    } else if (phase == 0) {
      gauge.read(slam, report.state_dim);
      gauge.compare(births > 0, from_priors, summary);
    }
  }
  summary.unsound = gauge.unsound();
  judge_map(bed, map_of(slam, config), summary);
  summary.lens_nees = judge_lens(slam, bed.lens());
  walls.judge(slam, map_of(slam, config), summary);
  if (config.clock_ns != nullptr && !bed_options.circle)
    summary.cost = cost_of_20_rows(bed, slam, pose, bed_options.frames, bed_options.rate_hz);
  return summary;
}

}  // namespace pfsim
