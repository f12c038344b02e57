#include "filter_slam/planes/plane_points.h"

#include <algorithm>
#include <cmath>

#include "belief/plane_membership.h"
#include "belief/tuning.h"
#include "filter_slam/features/wall_rays.h"
#include "frame/plane_settings.h"
#include "frame/tuning.h"
#include "model/camera_at.h"

namespace pf {

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
    const bool on_trial = map.features[state.block[slot].owner].on_trial;
    points.on_trial += on_trial ? 1 : 0;
    if (outline == nullptr || on_trial) return;
    uv[count++] = plane_coordinates(state.frame_of(state.block[plane]), filter.point(slot));
    if (count < kBatch) return;
    extend_outline(outline, uv, reject_isolated(uv, count));
    count = 0;
  });
  if (count > 0) extend_outline(outline, uv, reject_isolated(uv, count));
  return points;
}

void support(const Filter& filter, Map& map, int plane_entry, int slot) {
  const State& state = filter.state();
  const Vec2 uv = plane_coordinates(state.frame_of(state.block[map.planes[plane_entry].slot]), filter.point(slot));
  extend_outline(&map.planes[plane_entry].support, &uv, 1);
}

FoldRule fold_rule(const Settings& settings, const PlaneEntry& plane) {
  FoldRule rule = settings.fold;
  if (plane.known) rule.roughness = plane.roughness;
  return rule;
}

bool is_before_wall(const Filter& filter, const Map& map, int plane_entry, const Vec3& p_W) {
  const Vec3 c_W = camera_at(filter.state(), Scalar(0)).p_W;
  return sees_through_outline(map.planes, FilterPlanes{filter, map}, plane_entry, c_W, p_W);
}

bool is_in_reach(const Settings& settings, const Filter& filter, const Map& map, int plane_entry, const Vec3& p_W) {
  if (map.planes[plane_entry].known) return is_before_wall(filter, map, plane_entry, p_W);
  const PlaneFrame& frame = filter.state().frame_of(filter.state().block[map.planes[plane_entry].slot]);
  const PlaneOutline& known = map.planes[plane_entry].support;
  const Scalar reach = std::min(tuning::plane_keeper::kReach * std::sqrt(outline_area(known)), settings.plane_radius);
  return outline_contains(known, plane_coordinates(frame, p_W), reach);
}

bool lies_on(const Settings& settings, const Filter& filter, const Map& map, int plane, int slot) {
  Scalar d, variance;
  if (!filter.distance(plane, slot, &d, &variance)) return false;
  const int entry = map.planes.entry_at(plane);
  const FoldRule rule = entry < 0 ? settings.fold : fold_rule(settings, map.planes[entry]);
  const Scalar range = (filter.point(slot) - filter.state().body.p_W).norm();
  if (entry < 0 || !map.planes[entry].known)
    return log_odds_on_plane(d, variance, rule.roughness, settings.inverse_depth_relative_sigma * range) >
           tuning::plane_membership::kSure;
  const Scalar most = distance_at(settings, range), limit = most * most;
  const Scalar noise = rule.roughness * rule.roughness;
  return d * d <= (limit + noise) * Scalar(4) && variance <= limit && d * d < rule.gate * (variance + noise);
}

}  // namespace pf
