#include "filter_slam/planes/plane_folding.h"

#include <algorithm>
#include <cmath>

#include "base/table_entries.h"
#include "filter_slam/planes/plane_points.h"
#include "frame/plane_settings.h"
#include "frame/tuning.h"

namespace pf {

using namespace tuning::plane_keeper;

void unfold_outliers(const Settings& settings, Filter& filter, Map& map) {
  for (const int i : used_entries(map.features)) {
    if (map.features[i].rejections < kMaxRejections) continue;
    const int slot = map.features[i].slot;
    if (!is_planar(filter.state().block[slot].kind)) continue;
    const int plane = filter.state().plane_of(slot);
    const int children = filter.state().block[plane].children;
    if (!filter.unfold(slot, kUnfoldSigma * settings.plane_distance)) continue;
    map.features[i].rejections = 0;
    map.features[i].observations = 1;  // has to converge again before it may be folded
    // What one point that was wrong by about plane_distance has done to the plane.
    const Vec3 sigma = wrong_points_sigma(settings) / static_cast<Scalar>(std::max(children, 1));
    filter.inflate(plane, sigma.cwiseProduct(sigma).asDiagonal());
    const int entry = map.planes.entry_at(plane);
    if (entry < 0) continue;
    ++map.planes[entry].outliers;
    // The outlier may have been a vertex: the outline starts again from the other points, or from the plan.
    map.planes[entry].seen = map.planes[entry].plan;
  }
}

Vec3 wrong_points_sigma(const Settings& settings) {
  const Scalar extent = Scalar(0.25) * settings.plane_radius;
  return Vec3(settings.plane_distance / extent, settings.plane_distance / extent, settings.plane_distance);
}

void fold_into(const Settings& settings, Filter& filter, Map& map, const CertainPoints& certain, int plane_entry) {
  const int plane = map.planes[plane_entry].slot;
  const PlaneEntry& entry = map.planes[plane_entry];
  if (entry.doubted) return;
  const Block& block = filter.state().block[plane];
  const PlaneFrame& frame = filter.state().frame_of(block);
  const FoldRule rule = fold_rule(settings, entry);
  const Scalar near = settings.plane_distance + (entry.known ? rule.roughness : Scalar(0));
  int slots[Filter::kMaxFolded];
  const int limit = std::min(Filter::kMaxFolded, settings.max_observations);
  int count = 0;
  for (int i = 0; i < map.features.capacity() && count < limit; ++i) {
    if (!certain.is_converged(i)) continue;
    const int slot = map.features[i].slot;
    const Vec3 p_W = filter.point(slot);
    if (!is_in_reach(settings, filter, map, plane_entry, p_W)) continue;
    const Scalar farther = distance_at(settings, (p_W - filter.state().body.p_W).norm()) / settings.plane_distance;
    if (std::abs(plane_distance(frame, block.xyz(), p_W)) > Scalar(2) * near * farther) continue;
    Mat3 covariance;
    if (!lies_on(settings, filter, map, plane, slot) || !certain.is_certain(i, &covariance)) continue;
    slots[count++] = slot;
  }
  unsigned char folded[Filter::kMaxFolded];
  if (count == 0 || filter.fold(plane, slots, count, rule, folded) == 0) return;
  for (int i = 0; i < count; ++i)
    if (folded[i] != 0) support(filter, map, plane_entry, slots[i]);
}

void fix_on(const Settings& settings, Filter& filter, const Map& map, int plane_entry) {
  const int plane = map.planes[plane_entry].slot;
  const State& state = filter.state();
  int group[Filter::kMaxFolded], slots[Filter::kMaxFolded];
  int group_count = 0, count = 0;
  const bool has_group = filter.group_of(plane) >= 0;
  state.for_each_planar(plane, [&](int slot) {
    const Block& block = state.block[slot];
    if (group_count == Filter::kMaxFolded || map.features[block.owner].was_missed) return;
    if (map.features[block.owner].on_trial) return;
    if (block.kind == BlockKind::kPlanePoint) group[group_count++] = slot;
  });
  if (!has_group && group_count < 2 * kMinFixed) return;
  const int limit = std::min(Filter::kMaxFolded, settings.max_observations);
  const Scalar variance = settings.fix_sigma * settings.fix_sigma;
  for (int k = 0; k < group_count && count < limit; ++k)
    if (filter.variance_in_group(group[k], group, group_count) < variance) slots[count++] = group[k];
  if (count == 0 || (!has_group && count < kMinFixed)) return;
  filter.fix(slots, count, settings.fix, group, group_count);
}

}  // namespace pf
