#include "filter_slam/planes/plane_discovery.h"

#include <algorithm>
#include <cmath>

#include "base/table_entries.h"
#include "filter_slam/planes/plane_points.h"
#include "filter_slam/planes/tuning.h"
#include "frame/plane_settings.h"
#include "map/plane_refit.h"

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
    candidate_[count].is_explained = false;
    candidate_[count].p_W = p_W;
    candidate_[count++].name = i;
  }
  return count;
}

bool PlaneDiscovery::take(const PlaneFit& fit, int* member, int members, std::uint32_t id) {
  for (int k = 0; k < members; ++k) member[k] = map_.features[candidate_[member[k]].name].slot;
  const int slot = filter_.add_plane(fit, member, members, settings_.fold.roughness);
  if (slot < 0) return false;
  // By the filter's own covariance, enough members must lie on it.
  int kept = 0;
  for (int k = 0; k < members; ++k) kept += lies_on(settings_, filter_, map_, slot, member[k]) ? 1 : 0;
  const int entry = kept > settings_.plane_min_points ? map_.planes.add(slot) : -1;
  if (entry < 0) {
    filter_.remove(&slot, 1);
    return false;
  }
  if (id != 0) map_.planes[entry].id = id;
  filter_.set_owner(slot, entry);
  for (int k = 0; k < members; ++k) support(filter_, map_, entry, member[k]);
  settings_.hooks.say("plane ", map_.planes[entry].id, id != 0 ? " found again: " : " found: ", kept, " of ", members,
                      " points lie on it");
  return true;
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
  take(fit, member, members, 0);
}

void PlaneDiscovery::resume() {
  std::uint32_t before = 0;
  for (std::uint32_t id = next_lost(before); id != 0; id = next_lost(before)) {
    before = id;
    int on = 0, known = 0;
    const int count = list_candidates();
    for (const int i : used_entries(map_.features)) on += places_.lost_plane(i) == id ? 1 : 0;
    for (int c = 0; c < count; ++c) known += places_.lost_plane(candidate_[c].name) == id ? 1 : 0;
    if (on > settings_.plane_min_points && known <= settings_.plane_min_points) continue;  // not yet
    const bool is_back = known > settings_.plane_min_points && resume_plane(id, count);
    if (is_back || tuning::plane_resumption::kKnownShare * known > on || on <= settings_.plane_min_points)
      places_.give_up(id);
  }
}

/// The least id of a lost plane above this one; 0: there is none.
std::uint32_t PlaneDiscovery::next_lost(std::uint32_t above) const {
  std::uint32_t least = 0;
  for (const int i : used_entries(map_.features)) {
    const std::uint32_t id = places_.lost_plane(i);
    if (id > above && (least == 0 || id < least)) least = id;
  }
  return least;
}

/// With the plane through its points for a hypothesis.
bool PlaneDiscovery::resume_plane(std::uint32_t id, int count) {
  if (filter_.state().planes >= filter_.state().max_planes || filter_.room() < 3) return false;
  Vec3 points[kMaxPlaneMembers];
  int known = 0;
  for (int c = 0; c < count && known < kMaxPlaneMembers; ++c)
    if (places_.lost_plane(candidate_[c].name) == id) points[known++] = candidate_[c].p_W;
  const Vec3 viewer_W = filter_.state().body.p_W;
  PlaneFit fit;
  if (!fit_plane(points, known, viewer_W, &fit)) return false;
  const PlaneSearchSettings search = plane_search_settings(settings_);
  PlaneRefit refit(candidate_, count, search, viewer_W);
  if (!refit.run({fit.frame.o_W, fit.frame.R_WP.col(2), 0})) return false;
  int member[kMaxPlaneMembers];
  std::copy(refit.members(), refit.members() + refit.member_count(), member);
  return take(refit.fit(), member, refit.member_count(), id);
}

}  // namespace pf
