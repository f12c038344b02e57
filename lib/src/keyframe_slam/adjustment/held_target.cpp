#include "keyframe_slam/adjustment/held_target.h"

#include <algorithm>

#include "base/table_entries.h"
#include "keyframe_slam/adjustment/tuning.h"

namespace pf {

using namespace tuning::keyframe_adjustment;

void HeldTarget::add_to(const KeyframeMap& map, AdjustedPoses* poses, AdjustedPoints* points) const {
  const int host = poses->count;
  for (int p = 0; p < points->count; ++p) {
    const Feature& f = map.feature(points->row[p]);
    if (!f.is_target) continue;
    const Vec3 at = view_.q_WC.conjugate() * (target_.point_W[f.external_id] - view_.c_W);
    const Scalar rho = 1 / at.norm();
    points->ray[p] = at.normalized();
    points->host[p] = host;
    points->rho[p] = rho;
    points->prior[p] = {rho, std::max(target_.sigma_m * rho, kTargetSigma) * rho};
    poses->pose[host] = {view_.q_WC, view_.c_W, false, nullptr};
    poses->keyframe[host] = -1;
    poses->count = host + 1;
  }
}

void HeldTarget::put_back(KeyframeMap* map) const {
  for (const int i : used_entries(*map))
    if (map->feature(i).is_target) map->place(i, target_.point_W[map->feature(i).external_id]);
}

}  // namespace pf
