#include "innovations.h"

#include <algorithm>
#include <cmath>

namespace pfsim {

using pf::sim::Pose;
using pf::sim::Vec3;

void LagOne::add(const double a[2], const double b[2]) {
  ab += a[0] * b[0] + a[1] * b[1];
  aa += a[0] * a[0] + a[1] * a[1];
  bb += b[0] * b[0] + b[1] * b[1];
}

void LagOne::add(const LagOne& other) {
  ab += other.ab;
  aa += other.aa;
  bb += other.bb;
}

double LagOne::value() const { return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0; }

void InnovationSums::add(const InnovationSums& other) {
  nis += other.nis;
  count += other.count;
  square += other.square;
  match_square += other.match_square;
  match_count += other.match_count;
  match_far += other.match_far;
  innovation.add(other.innovation);
  match.add(other.match);
}

FrameDepth::FrameDepth(const pf_sim_t* sim, const pf_camera_t& camera)
    : sim_(sim),
      width_(camera.width),
      depth_(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height)),
      surface_(depth_.size()) {}

std::size_t FrameDepth::look(const pf_pose_t& truth, long x, long y) {
  if (truth.t_ns != t_ns_) pf_sim_depth(sim_, &truth, depth_.data(), surface_.data());
  t_ns_ = truth.t_ns;
  return static_cast<std::size_t>(y * width_ + x);
}

double FrameDepth::at(const pf_pose_t& truth, long x, long y) { return static_cast<double>(depth_[look(truth, x, y)]); }

std::int32_t FrameDepth::surface_at(const pf_pose_t& truth, long x, long y) { return surface_[look(truth, x, y)]; }

InnovationWatch::InnovationWatch(const pf_config_t& config, const pf_target_t& points)
    : camera_(config.camera),
      points_(points),
      features_(static_cast<std::size_t>(config.capacity.max_features)),
      tracks_(static_cast<std::size_t>(config.capacity.max_features + config.capacity.max_observations)) {}

/// The target's points are in the map from the first frame with a pose on, and their ids do not change.
void InnovationWatch::learn_kinds(const pf_slam_t* slam) {
  if (!target_index_.empty()) return;
  std::size_t count = 0;
  pf_get_features(slam, features_.data(), features_.size(), &count);
  for (std::size_t i = 0; i < std::min(count, features_.size()); ++i)
    if (features_[i].is_target) target_index_[features_[i].id] = static_cast<int>(features_[i].external_id);
  for (const auto& [id, index] : target_index_) {
    const double* p = points_.points_W[index];
    place_W_[id] = {p[0], p[1], p[2]};
  }
}

void InnovationWatch::learn_places(const pf_pose_t& truth, FrameDepth& depth) {
  const Pose pose{pf::sim::rotation_of(truth.q_WC), {truth.p_WC[0], truth.p_WC[1], truth.p_WC[2]}};
  for (const pf_match_t& track : tracks_) {
    if (track.status != PF_MATCH_NEW) continue;
    const auto x = std::lround(track.measured_px[0]), y = std::lround(track.measured_px[1]);
    double ray[3];
    if (x < 0 || y < 0 || x >= camera_.width || y >= camera_.height ||
        pf_camera_unproject(&camera_, track.measured_px, ray) != PF_OK)
      continue;
    const double z = depth.at(truth, x, y);
    if (z > 0) place_W_[track.id] = pose.p_WC + pose.R_WC * (Vec3{ray[0], ray[1], ray[2]} * (z / ray[2]));
  }
}

bool InnovationWatch::match_error(const pf_match_t& track, const Pose& truth, double error[2]) const {
  const auto place = place_W_.find(track.id);
  if (place == place_W_.end()) return false;
  const Vec3 p = truth.R_WC.transposed() * (place->second - truth.p_WC);
  const double p_C[3] = {p.x, p.y, p.z};
  double pixel[2];
  if (pf_camera_project(&camera_, p_C, pixel) != PF_OK) return false;
  error[0] = track.measured_px[0] - pixel[0];
  error[1] = track.measured_px[1] - pixel[1];
  return true;
}

void InnovationWatch::read(const pf_slam_t* slam, const pf_pose_t& truth, FrameDepth& depth) {
  ++frame_;
  learn_kinds(slam);
  std::size_t count = 0;
  tracks_.resize(tracks_.capacity());
  pf_get_matches(slam, tracks_.data(), tracks_.size(), &count);
  tracks_.resize(std::min(count, tracks_.size()));
  learn_places(truth, depth);
  const Pose pose{pf::sim::rotation_of(truth.q_WC), {truth.p_WC[0], truth.p_WC[1], truth.p_WC[2]}};
  for (const pf_match_t& track : tracks_) {
    // A track without an ellipse was not predicted: it started the run.
    if (track.status != PF_MATCH_INLIER || !(track.covariance_px[0] > 0)) continue;
    const bool target = target_index_.count(track.id) > 0;
    const TrackKind kind = target                                   ? TrackKind::kTarget
                           : track.kind == PF_FEATURE_INVERSE_DEPTH ? TrackKind::kInverseDepth
                                                                    : TrackKind::kPoint;
    InnovationSums& sums = sums_[static_cast<std::size_t>(kind)];
    Past now;
    now.frame = frame_;
    for (int k = 0; k < 2; ++k) now.innovation[k] = track.measured_px[k] - track.predicted_px[k];
    sums.nis += track.nis;
    sums.count += 1;
    sums.square += now.innovation[0] * now.innovation[0] + now.innovation[1] * now.innovation[1];
    if (match_error(track, pose, now.match)) {
      now.match_valid = std::hypot(now.match[0], now.match[1]) < kMatchReach;
      (now.match_valid ? sums.match_count : sums.match_far) += 1;
      if (now.match_valid) sums.match_square += now.match[0] * now.match[0] + now.match[1] * now.match[1];
    }
    Past& before = past_[track.id];
    if (before.frame == frame_ - 1) {
      sums.innovation.add(before.innovation, now.innovation);
      if (before.match_valid && now.match_valid) sums.match.add(before.match, now.match);
    }
    now.frames = before.frames + 1;
    before = now;
  }
}

double InnovationWatch::track_length() const {
  double frames = 0;
  for (const auto& [id, past] : past_) frames += past.frames;
  return past_.empty() ? 0 : frames / static_cast<double>(past_.size());
}

}  // namespace pfsim
