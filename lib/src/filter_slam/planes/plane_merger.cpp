#include "filter_slam/planes/plane_merger.h"

#include <algorithm>
#include <cmath>

#include "filter_slam/planes/plane_lifecycle.h"
#include "filter_slam/planes/plane_points.h"
#include "frame/tuning.h"

namespace pf {

using namespace tuning::plane_lifecycle;

bool PlaneMerger::is_same_plane(int entry, int other) const {
  const State& state = filter_.state();
  const int slot = map_.planes[entry].slot;
  const bool known = map_.planes[entry].known;
  const FoldRule rule = fold_rule(settings_, map_.planes[entry]);
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
    if (known && !is_before_wall(filter_, map_, entry, filter_.point(point))) return;
    if (d * d < kSamePlaneGate * near) ++close;
  });
  // Both tests: every point passes the gate of a plane that is hardly known.
  return points >= kMinPoints && kPerOutlier * (points - inliers) <= points && kPerOutlier * (points - close) <= points;
}

void PlaneMerger::merge_into(int plane_entry) {
  const int plane = map_.planes[plane_entry].slot;
  const bool known = map_.planes[plane_entry].known;
  if (map_.planes[plane_entry].doubted) return;
  for (int k = 0; k < map_.planes.capacity(); ++k) {
    if (k == plane_entry || !map_.planes.used(k) || map_.planes[k].known) continue;
    const int other = map_.planes[k].slot;
    // A wall takes the other plane in, however few points it has, and so does a plane of a loaded map.
    const bool smaller = filter_.state().block[other].children > filter_.state().block[plane].children;
    const bool stays = known || (map_.planes[plane_entry].remembered && !map_.planes[k].remembered);
    if ((smaller && !stays) || !is_same_plane(plane_entry, other)) continue;
    if (!give_points(k, plane_entry)) return;
    give_outline(k, plane_entry);
    verticals_.merge(k, plane_entry);
    const std::uint32_t merged = map_.planes[k].id;
    map_.planes.remember_merge(merged, map_.planes[plane_entry].id);
    dissolve_plane(filter_, map_, features_, settings_.plane_distance, k);
    settings_.hooks.say("plane ", merged, " merged into ", known ? "wall " : "plane ", map_.planes[plane_entry].id,
                        ", which has ", filter_.state().block[plane].children, " points now");
    return;
  }
}

void PlaneMerger::give_outline(int from_entry, int to_entry) {
  const State& state = filter_.state();
  const PlaneEntry& giver = map_.planes[from_entry];
  PlaneEntry& taker = map_.planes[to_entry];
  const Block &from = state.block[giver.slot], &to = state.block[taker.slot];
  for (int i = 0; i < giver.seen.count; ++i) {
    const Vec3 p_W = plane_point(state.frame_of(from), from.xyz(), giver.seen.uv[i]);
    const Vec2 uv = plane_coordinates(state.frame_of(to), p_W);
    extend_outline(&taker.seen, &uv, 1);
  }
}

bool PlaneMerger::give_points(int from_entry, int to_entry) {
  const int other = map_.planes[from_entry].slot, plane = map_.planes[to_entry].slot;
  FoldRule rule = fold_rule(settings_, map_.planes[to_entry]);
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
      if (folded[i] != 0) support(filter_, map_, to_entry, slots[i]);
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

}  // namespace pf
