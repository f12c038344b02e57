#include <algorithm>
#include <cmath>

#include "filter_slam/planes/plane_keeper.h"
#include "frame/plane_settings.h"
#include "frame/tuning.h"

/// Whole planes: discover, merge, change the frame, outline, dissolve. Gee 2007, section 3.3.

namespace pf {
namespace {

using namespace tuning::plane_lifecycle;

}  // namespace
/// Lists converged, well known points that lie on no plane yet. Returns how many.
int PlaneKeeper::list_candidates() {
  int count = 0;
  const Scalar limit = Scalar(2) * settings_.plane_distance;
  for (int i = 0; i < map_.features.capacity(); ++i) {
    if (!is_settled(i)) continue;
    const Vec3 p_W = filter_.point(map_.features[i].slot);
    bool taken = false;
    for (int k = 0; k < map_.planes.capacity() && !taken; ++k) {
      if (!map_.planes.used(k) || map_.planes[k].apart) continue;
      const Block& plane = filter_.state().block[map_.planes[k].slot];
      const PlaneFrame& frame = filter_.state().frame_of(plane);
      taken = std::abs(plane_distance(frame, plane.xyz(), p_W)) < limit && is_in_reach(k, p_W);
    }
    if (taken || !is_certain(i, &candidate_[count].covariance)) continue;
    candidate_[count].p_W = p_W;
    candidate_[count++].name = i;
  }
  return count;
}

/// Looks for one new plane among these points.
void PlaneKeeper::discover() {
  const std::uint32_t number = data_.searches++;  // whatever is found, and whether there is anything to search
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
  for (int k = 0; k < members; ++k) kept += lies_on(slot, member[k]) ? 1 : 0;
  const int entry = kept > settings_.plane_min_points ? map_.planes.add(slot) : -1;
  if (entry < 0) {
    filter_.remove(&slot, 1);
    return;
  }
  filter_.set_owner(slot, entry);
  for (int k = 0; k < members; ++k) support(entry, member[k]);
  settings_.hooks.say("found a plane");
}

/// Whether the points of plane `other` lie on plane `slot`. A wall may be far from where the plan has it, by its own variance.
bool PlaneKeeper::same_plane(int slot, int other) const {
  const State& state = filter_.state();
  const int entry = map_.planes.entry_at(slot);
  const bool known = map_.planes[entry].known;
  const FoldRule rule = fold_rule(entry);
  const Block &a = state.block[slot], &b = state.block[other];
  Vec3 n_a, n_b;
  Scalar d_a, d_b;
  plane_normal(state.frame_of(a), a.xyz(), &n_a, &d_a);
  plane_normal(state.frame_of(b), b.xyz(), &n_b, &d_b);
  const Scalar cosine = map_.planes[entry].two_sided ? std::abs(n_a.dot(n_b)) : n_a.dot(n_b);
  if (cosine < kMinNormalCosine) return false;
  int points = 0, inliers = 0, close = 0;
  state.for_each_planar(other, [&](int point) {
    Scalar d, variance;
    if (map_.features[state.block[point].owner].on_trial) return;
    ++points;
    if (!filter_.distance(slot, point, &d, &variance)) return;
    variance += rule.roughness * rule.roughness;
    if (d * d < kSamePlaneGate * variance) ++inliers;
    Scalar near = settings_.plane_distance * settings_.plane_distance;
    if (known) near += filter_.plane_variance(slot, filter_.point(point)) + rule.roughness * rule.roughness;
    if (known && !is_before_wall(entry, filter_.point(point))) return;
    if (d * d < kSamePlaneGate * near) ++close;
  });
  // Both tests: every point passes the gate of a plane that is hardly known.
  return points >= kMinPoints && 10 * inliers >= 9 * points && 10 * close >= 9 * points;
}

/// Merges one other plane that is the same into this one.
void PlaneKeeper::merge_into(int plane_entry) {
  const int plane = map_.planes[plane_entry].slot;
  const bool known = map_.planes[plane_entry].known;
  if (map_.planes[plane_entry].doubted) return;
  for (int k = 0; k < map_.planes.capacity(); ++k) {
    if (k == plane_entry || !map_.planes.used(k) || map_.planes[k].known) continue;
    const int other = map_.planes[k].slot;
    // A wall takes the other plane in, however few points it has.
    const bool smaller = filter_.state().block[other].children > filter_.state().block[plane].children;
    if ((smaller && !known) || !same_plane(plane, other)) continue;
    if (!give_points(k, plane_entry)) return;
    const State& state = filter_.state();
    const Block &from = state.block[other], &to = state.block[plane];
    for (int i = 0; i < map_.planes[k].seen.count; ++i) {
      const Vec3 p_W = plane_point(state.frame_of(from), from.xyz(), map_.planes[k].seen.uv[i]);
      const Vec2 uv = plane_coordinates(state.frame_of(to), p_W);
      extend_outline(&map_.planes[plane_entry].seen, &uv, 1);
    }
    if (told_ != nullptr && !told_row(plane_entry)->is_told()) *told_row(plane_entry) = *told_row(k);
    map_.planes.remember_merge(map_.planes[k].id, map_.planes[plane_entry].id);
    dissolve(k);
    settings_.hooks.say("merged two planes");
    return;
  }
}

/// Folds the points of one plane into another, as far as they pass the gate. False if a fixed point could not be released first.
bool PlaneKeeper::give_points(int from_entry, int to_entry) {
  const int other = map_.planes[from_entry].slot, plane = map_.planes[to_entry].slot;
  FoldRule rule = fold_rule(to_entry);
  rule.gate = kMergeGate;
  bool released = true;
  filter_.state().for_each_planar(other, [&](int slot) {
    if (filter_.state().block[slot].kind == BlockKind::kGroupedPoint) released = released && filter_.release(slot);
  });
  if (!released) return false;
  int slots[Filter::kMaxFolded];
  unsigned char folded[Filter::kMaxFolded];
  int count = 0;
  const auto give = [&] {
    if (count > 0) filter_.fold(plane, slots, count, rule, folded);
    for (int i = 0; i < count; ++i)
      if (folded[i] != 0) support(to_entry, slots[i]);
    count = 0;
  };
  filter_.state().for_each_planar(other, [&](int slot) {
    if (filter_.state().block[slot].kind != BlockKind::kPlanePoint) return;
    slots[count++] = slot;
    if (count == std::min(Filter::kMaxFolded, settings_.max_observations)) give();
  });
  give();
  return true;
}

/// Gives a plane that has rotated away from its frame a new frame, parallel to the plane. A wall keeps the one that its prior is about.
void PlaneKeeper::settle_frame(int plane_entry) {
  const int plane = map_.planes[plane_entry].slot;
  const State& state = filter_.state();
  const Block& block = state.block[plane];
  const Vec3 x = block.xyz();
  if (map_.planes[plane_entry].prior[0] > Scalar(0)) return;
  const bool slanted = x(0) * x(0) + x(1) * x(1) > kMaxSlant * kMaxSlant;
  if (!slanted || filter_.group_of(plane) >= 0) return;
  PlaneFrame to = state.frame_of(block);
  Vec3 normal;
  Scalar d;
  plane_normal(to, x, &normal, &d);
  to.o_W += x(2) * to.R_WP.col(2);
  const Vec3 along = (to.R_WP.col(0) - normal * normal.dot(to.R_WP.col(0))).normalized();
  to.R_WP.col(0) = along;
  to.R_WP.col(1) = normal.cross(along);
  to.R_WP.col(2) = normal;
  const PlaneFrame from = state.frame_of(block);
  if (!filter_.reanchor(plane, to)) return;
  PlaneOutline& known = map_.planes[plane_entry].support;
  PlaneOutline& seen = map_.planes[plane_entry].seen;
  PlaneOutline& plan = map_.planes[plane_entry].plan;
  for (PlaneOutline* outline : {&known, &seen, &plan})
    for (int i = 0; i < outline->count; ++i)
      outline->uv[i] = plane_coordinates(to, plane_point(from, x, outline->uv[i]));
}

/// Unfolds all points of a plane and removes it.
void PlaneKeeper::dissolve(int plane_entry) {
  const int plane = map_.planes[plane_entry].slot;
  filter_.state().for_each_planar(plane, [&](int slot) {
    const int feature = filter_.state().block[slot].owner;
    if (map_.features[feature].on_trial || !filter_.unfold(slot, settings_.plane_distance)) features_.drop(&feature, 1);
  });
  filter_.remove(&plane, 1);
  map_.planes.remove(plane_entry);
}

PlanePoints outline_plane(const Filter& filter, const Map& map, int plane_entry, PlaneOutline* outline) {
  constexpr int kBatch = kOutlineBatch;
  const State& state = filter.state();
  const int plane = map.planes[plane_entry].slot;
  PlanePoints points;
  if (outline != nullptr) *outline = map.planes[plane_entry].seen;
  Vec2 uv[kBatch];
  int count = 0;
  state.for_each_planar(plane, [&](int slot) {
    ++points.folded;
    if (state.block[slot].kind == BlockKind::kGroupedPoint) ++points.fixed;
    if (map.features[state.block[slot].owner].on_trial) ++points.on_trial;
    if (outline == nullptr) return;
    uv[count++] = plane_coordinates(state.frame_of(state.block[plane]), filter.point(slot));
    if (count < kBatch) return;
    extend_outline(outline, uv, reject_isolated(uv, count));
    count = 0;
  });
  if (count > 0) extend_outline(outline, uv, reject_isolated(uv, count));
  return points;
}

/// Dissolves a plane that has too few points for kMaxWeakFrames; likewise a new one that never gets more than plane_min_points. Dissolves
/// at once a plane with more outliers so far than points. Walls stay.
void PlaneKeeper::dissolve_weak() {
  for (int i = 0; i < map_.planes.capacity(); ++i) {
    if (!map_.planes.used(i) || map_.planes[i].known) continue;
    const PlanePoints on = outline_plane(filter_, map_, i, nullptr);
    const int points = on.folded - on.on_trial;
    map_.planes[i].max_points = std::max<int>(map_.planes[i].max_points, points);
    const int upheld = map_.planes[i].upheld;
    const bool proven = map_.planes[i].max_points > settings_.plane_min_points || upheld > 0;
    map_.planes[i].weak = points < kMinPoints || !proven ? map_.planes[i].weak + 1 : 0;
    const bool denied = map_.planes[i].outliers > points + PlaneEntry::kUpheldWorth * upheld;
    if (!denied && map_.planes[i].weak <= kMaxWeakFrames) continue;
    if (denied || !proven) filter_.forget_through(map_.planes[i].slot, doubt());
    dissolve(i);
  }
}

}  // namespace pf
