#include "wall_watch.h"

#include <algorithm>
#include <cmath>

#include "plane_error.h"

namespace pfsim {
namespace {

using pf::sim::Vec3;

constexpr double kWallDistance = 2.0;  // of every wall from the middle of the room [m]
constexpr int kLeastPoints = 4;        // a plane with fewer has not begun to fold
constexpr int kSeenWell = 10;          // points of a wall in the map, so that it ought to be found

std::vector<pf_plane_t> planes_of(const pf_slam_t* slam) {
  std::vector<pf_plane_t> planes(64);
  std::size_t count = 0;
  pf_get_planes(slam, planes.data(), planes.size(), &count);
  planes.resize(std::min(count, planes.size()));
  return planes;
}

}  // namespace

WallWatch::Share WallWatch::share_of(std::uint32_t plane, const std::vector<pf_feature_t>& map) const {
  int on[4] = {}, points = 0;
  for (const pf_feature_t& f : map) {
    if (f.plane != plane || f.external_id >= bed_.points().size()) continue;
    ++points;
    // Where walls meet, a point may well be taken for one of the other wall.
    const Vec3& truth = bed_.points()[f.external_id].p_W;
    for (int wall = 0; wall < 4; ++wall) {
      const Vec3 n = Bed::wall_normal(wall);
      const double normal[3] = {n.x, n.y, n.z};
      double variance = 0;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) variance += normal[i] * f.covariance[3 * i + j] * normal[j];
      on[wall] += std::fabs(n.dot(truth) + kWallDistance) < std::max(0.01, 3 * std::sqrt(variance));
    }
  }
  Share share;
  share.points = points;
  for (int wall = 0; wall < 4; ++wall) {
    if (points == 0 || on[wall] <= share.share * points) continue;
    share.share = on[wall] / static_cast<double>(points);
    share.wall = wall;
  }
  return share;
}

void WallWatch::look(const pf_slam_t* slam, const std::vector<pf_feature_t>& map) {
  for (const pf_plane_t& plane : planes_of(slam)) {
    const Share share = share_of(plane.id, map);
    if (share.points < kLeastPoints) continue;
    const auto found = worst_.find(plane.id);
    if (found == worst_.end())
      worst_[plane.id] = share.share;
    else
      found->second = std::min(found->second, share.share);
  }
}

void WallWatch::judge(const pf_slam_t* slam, const std::vector<pf_feature_t>& map, RunSummary& summary) const {
  int planes_on[4] = {};
  for (const pf_plane_t& plane : planes_of(slam)) {
    const Share share = share_of(plane.id, map);
    if (share.points < kLeastPoints) continue;
    summary.planes_true += share.share == 1;
    summary.planes_mixed += share.share < 1 && share.share >= 0.8;
    summary.planes_false += share.share < 0.8;
    if (share.wall < 0) continue;
    if (planes_on[share.wall]++ > 0) ++summary.planes_duplicate;
    if (share.share < 1) continue;
    summary.plane_nees_sum += normalised_plane_error(plane, bed_.wall_normal(share.wall), -kWallDistance);
    ++summary.planes_judged;
  }
  for (const auto& [id, share] : worst_) {
    ++summary.planes_ever;
    summary.planes_ever_true += share == 1;
    summary.planes_ever_false += share < 0.8;
  }
  for (int wall = 0; wall < 4; ++wall) {
    int points = 0;
    for (const pf_feature_t& f : map)
      points += f.external_id < bed_.points().size() && bed_.points()[f.external_id].wall == wall &&
                f.observations >= 20 && f.kind != PF_FEATURE_INVERSE_DEPTH;
    if (points < kSeenWell) continue;
    ++summary.walls_seen;
    summary.walls_found += planes_on[wall] > 0;
  }
}

}  // namespace pfsim
