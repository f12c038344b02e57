#include "keyframe_slam/memory/map_join.h"

#include <algorithm>
#include <cmath>

#include "base/table_entries.h"
#include "frame/tuning.h"
#include "geometry/common_ratio.h"
#include "geometry/so3.h"
#include "memory/tuning.h"

namespace pf {

using namespace tuning::map_join;

void JoinFinder::look(const CameraView& view, Scalar depth) {
  const MapJoin before = before_;
  MapJoin now;
  if (!map_.places.has_other() || !recognise(view, &now)) return;
  before_ = now;
  const Scalar about = tuning::relocaliser::kAboutView;
  const bool same = before.map_id == now.map_id && std::abs(std::log(before.T.s / now.T.s)) < about &&
                    log_so3(before.T.q * now.T.q.conjugate()).norm() < about &&
                    (before.T.of(view.c_W) - now.T.of(view.c_W)).norm() < about * depth * now.T.s;
  if (same) found_ = now;
}

/// Distances of points of the other map over those of points of this one that are seen in the same pixels.
int JoinFinder::list_ratios(const PlaceMatches& matches, const PoseEstimate& there, const CameraView& view,
                            Scalar* ratio) const {
  const Scalar bound = tuning::place_search::kBoundWidth * static_cast<Scalar>(map_.camera().width);
  int count = 0;
  for (int m = 0; m < matches.count; ++m) {
    const PnpPoint& point = matches.point[m];
    Vec2 z;
    if (!project(map_.camera(), Vec3(there.q_WC.conjugate() * (point.m - there.p_WC)), &z) ||
        (z - point.pixel).norm() > bound)
      continue;
    Scalar nearest = tuning::place_search::kSameCorner, here = 0;
    for (const int i : used_entries(map_)) {
      if (!map_.point(i).has_depth) continue;
      const Vec3 to_W = map_.position(i) - view.c_W;
      if (!project(map_.camera(), Vec3(view.q_WC.conjugate() * to_W), &z) || (z - point.pixel).norm() > nearest)
        continue;
      nearest = (z - point.pixel).norm();
      here = to_W.norm();
    }
    if (here > Scalar(0)) ratio[count++] = (point.m - there.p_WC).norm() / here;
  }
  return count;
}

/// With the camera at (R, c) in this map and at (R_o, c_o) in the other one, and s the ratio of distances that most points have in common:
///
///   R_T = R_o Rᵀ,   t = c_o - s R_T c
bool JoinFinder::recognise(const CameraView& view, MapJoin* out) {
  Recalled best;
  PlaceMatches matches;
  if (!recall_.find_other(&best, &matches)) return false;
  Scalar ratio[PlaceMatches::kMax];
  const int count = list_ratios(matches, best.pose, view, ratio);
  const CommonRatio common = find_common_ratio(ratio, count, kOneScale);
  if (common.votes < kMinRatios || kMinSame * common.votes < count) return false;
  out->map_id = map_.places[map_.places.entry_of(best.place)].map_id;
  out->view = view;
  out->T.s = common.ratio;
  out->T.q = (best.pose.q_WC * view.q_WC.conjugate()).normalized();
  out->T.t = best.pose.p_WC - common.ratio * (out->T.q * view.c_W);
  out->covariance = best.pose.covariance;
  out->sigma_scale = (kOneScale - 1) / std::sqrt(static_cast<Scalar>(common.votes));
  return true;
}

}  // namespace pf
