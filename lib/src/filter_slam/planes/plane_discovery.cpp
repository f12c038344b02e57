#include "filter_slam/planes/plane_discovery.h"

#include <cmath>

#include "filter_slam/planes/plane_points.h"
#include "frame/plane_settings.h"

namespace pf {

bool PlaneDiscovery::layout(Arena& arena, int max_features) {
  candidate_ = arena.take<PlaneCandidate>(static_cast<std::size_t>(max_features));
  return arena.ok();
}

int PlaneDiscovery::list_candidates() {
  int count = 0;
  const Scalar limit = Scalar(2) * settings_.plane_distance;
  for (int i = 0; i < map_.features.capacity(); ++i) {
    if (!certain_.is_settled(i)) continue;
    const Vec3 p_W = filter_.point(map_.features[i].slot);
    bool taken = false;
    for (int k = 0; k < map_.planes.capacity() && !taken; ++k) {
      if (!map_.planes.used(k) || map_.planes[k].apart) continue;
      const Block& plane = filter_.state().block[map_.planes[k].slot];
      const PlaneFrame& frame = filter_.state().frame_of(plane);
      taken =
          std::abs(plane_distance(frame, plane.xyz(), p_W)) < limit && is_in_reach(settings_, filter_, map_, k, p_W);
    }
    if (taken || !certain_.is_certain(i, &candidate_[count].covariance)) continue;
    candidate_[count].p_W = p_W;
    candidate_[count++].name = i;
  }
  return count;
}

void PlaneDiscovery::discover() {
  const std::uint32_t number = searches_++;  // whatever is found, and whether there is anything to search
  if (filter_.state().planes >= filter_.state().max_planes || filter_.room() < 3) return;
  const int count = list_candidates();
  if (count <= settings_.plane_min_points) return;
  const PlaneSearchSettings search = plane_search_settings(settings_);
  PlaneFit fit;
  int member[kMaxPlaneMembers];
  int members = 0;
  if (!search_plane(candidate_, count, search, filter_.state().body.p_W, number, &fit, member, &members)) return;
  for (int k = 0; k < members; ++k) member[k] = map_.features[candidate_[member[k]].name].slot;
  const int slot = filter_.add_plane(fit, member, members, settings_.fold.roughness);
  if (slot < 0) return;
  // By the filter's own covariance, enough members must lie on it.
  int kept = 0;
  for (int k = 0; k < members; ++k) kept += lies_on(settings_, filter_, map_, slot, member[k]) ? 1 : 0;
  const int entry = kept > settings_.plane_min_points ? map_.planes.add(slot) : -1;
  if (entry < 0) {
    filter_.remove(&slot, 1);
    return;
  }
  filter_.set_owner(slot, entry);
  for (int k = 0; k < members; ++k) support(filter_, map_, entry, member[k]);
  settings_.hooks.say("found a plane");
}

}  // namespace pf
