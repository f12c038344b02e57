#include "fold_watch.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace pfsim {

using pf::sim::Vec3;

namespace {

constexpr long kRim = 3;  // pixels about a feature that must show the same surface

double share_of(std::int64_t part, std::int64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

}  // namespace

void FoldSums::add(const FoldSums& other) {
  due += other.due;
  folded += other.folded;
  young += other.young;
  missing += other.missing;
  waiting += other.waiting;
  planar += other.planar;
  wrong += other.wrong;
}

FoldWatch::FoldWatch(const pf_sim_t* sim, const pf_config_t& config)
    : sim_(sim),
      camera_(config.camera),
      features_(static_cast<std::size_t>(config.capacity.max_features)),
      matches_(static_cast<std::size_t>(config.capacity.max_features + config.capacity.max_observations)) {}

void FoldWatch::learn_places(const pf_pose_t& truth, FrameDepth& depth) {
  const pf::sim::Mat3 R_WC = pf::sim::rotation_of(truth.q_WC);
  for (const pf_match_t& match : matches_) {
    if (match.status != PF_MATCH_NEW || seen_.count(match.id) != 0) continue;
    Seen& seen = seen_[match.id];
    const long x = std::lround(match.measured_px[0]), y = std::lround(match.measured_px[1]);
    if (x < kRim || y < kRim || x >= camera_.width - kRim || y >= camera_.height - kRim) continue;
    const std::int32_t surface = depth.surface_at(truth, x, y);
    bool rim = false;
    for (const long dx : {-kRim, 0L, kRim})
      for (const long dy : {-kRim, 0L, kRim}) rim = rim || depth.surface_at(truth, x + dx, y + dy) != surface;
    double n[3], d, ray[3];
    if (rim || pf_sim_surface(sim_, surface, n, &d) != PF_OK) continue;
    if (pf_camera_unproject(&camera_, match.measured_px, ray) != PF_OK || !(ray[2] > 0)) continue;
    const Vec3 along = Vec3{ray[0], ray[1], ray[2]} * (depth.at(truth, x, y) / ray[2]);
    seen.surface = surface;
    seen.p_W = Vec3{truth.p_WC[0], truth.p_WC[1], truth.p_WC[2]} + R_WC * along;
  }
}

/// Each plane is what most of its points lie on.
void FoldWatch::name_planes() {
  std::map<std::uint32_t, std::map<std::int32_t, int>> votes;
  for (const pf_feature_t& f : features_) {
    const auto seen = seen_.find(f.id);
    if (f.plane != 0 && seen != seen_.end() && seen->second.surface >= 0) ++votes[f.plane][seen->second.surface];
  }
  plane_surface_.clear();
  for (const auto& [plane, of_surface] : votes)
    plane_surface_[plane] = std::max_element(of_surface.begin(), of_surface.end(), [](const auto& a, const auto& b) {
                              return a.second < b.second;
                            })->first;
}

bool FoldWatch::has_plane(std::int32_t surface) const {
  return std::any_of(plane_surface_.begin(), plane_surface_.end(),
                     [&](const auto& plane) { return plane.second == surface; });
}

void FoldWatch::count_planar() {
  for (const pf_feature_t& f : features_) {
    const auto seen = seen_.find(f.id);
    if (f.plane == 0 || seen == seen_.end() || seen->second.surface < 0) continue;
    double n[3], d;
    if (pf_sim_surface(sim_, plane_surface_[f.plane], n, &d) != PF_OK) continue;
    ++sums_.planar;
    sums_.wrong += std::fabs(Vec3{n[0], n[1], n[2]}.dot(seen->second.p_W) - d) >= kWrongOffset;
  }
}

void FoldWatch::judge(const pf_feature_t& feature) {
  const std::int32_t surface = seen_[feature.id].surface;
  ++sums_.due;
  if (feature.plane != 0 && plane_surface_[feature.plane] == surface)
    ++sums_.folded;
  else if (feature.kind == PF_FEATURE_INVERSE_DEPTH)
    ++sums_.young;
  else
    ++(has_plane(surface) ? sums_.waiting : sums_.missing);
}

void FoldWatch::read(const pf_slam_t* slam, const pf_pose_t& truth, FrameDepth& depth) {
  std::size_t count = 0;
  matches_.resize(matches_.capacity());
  if (pf_get_matches(slam, matches_.data(), matches_.size(), &count) < 0) count = 0;
  matches_.resize(std::min(count, matches_.size()));
  features_.resize(features_.capacity());
  if (pf_get_features(slam, features_.data(), features_.size(), &count) < 0) count = 0;
  features_.resize(std::min(count, features_.size()));
  learn_places(truth, depth);
  name_planes();
  count_planar();

  std::map<std::int32_t, int> in_view;
  for (const pf_match_t& match : matches_) {
    const auto seen = seen_.find(match.id);
    if (match.status == PF_MATCH_INLIER && seen != seen_.end()) ++in_view[seen->second.surface];
  }
  for (const pf_match_t& match : matches_) {
    const auto seen = seen_.find(match.id);
    if (match.status != PF_MATCH_INLIER || seen == seen_.end() || seen->second.surface < 0) continue;
    if (in_view[seen->second.surface] < kTogether || ++seen->second.together != kTogetherFrames) continue;
    const auto feature = std::find_if(features_.begin(), features_.end(),
                                      [&](const pf_feature_t& f) { return f.id == match.id && f.is_target == 0; });
    if (feature != features_.end()) judge(*feature);
  }
}

nlohmann::json folds_json(const FoldSums& sums) {
  return {{"due", sums.due},
          {"folded", sums.folded},
          {"share", share_of(sums.folded, sums.due)},
          {"young", sums.young},
          {"missing", sums.missing},
          {"waiting", sums.waiting},
          {"planar_frames", sums.planar},
          {"wrong_share", share_of(sums.wrong, sums.planar)}};
}

}  // namespace pfsim
