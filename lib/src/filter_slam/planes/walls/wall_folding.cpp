#include "filter_slam/planes/walls/wall_folding.h"

#include <algorithm>

#include "base/limits.h"
#include "filter_slam/features/tuning.h"
#include "filter_slam/features/wall_rays.h"
#include "filter_slam/planes/plane_points.h"
#include "map/wall_consensus.h"
#include "model/camera_at.h"

namespace pf {
namespace {

using namespace tuning::plane_walls;

/// A number below limit; changes the generator's state.
int draw(std::uint32_t* state, int limit) {
  *state = *state * 1664525u + 1013904223u;
  return static_cast<int>((*state >> 16) % static_cast<std::uint32_t>(limit));
}

}  // namespace

bool WallFolding::is_on_found_plane(int entry) const {
  if (!map_.features.used(entry) || map_.features[entry].on_trial || map_.features[entry].rejections > 0) return false;
  const int slot = map_.features[entry].slot;
  if (!is_planar(filter_.state().block[slot].kind)) return false;
  const int plane = map_.planes.entry_at(filter_.state().plane_of(slot));
  return plane >= 0 && !map_.planes[plane].known;
}

int WallFolding::list_before_wall(int plane_entry, int* slots, int capacity) {
  const int features = map_.features.capacity();
  const int from = draw(&data_.random, features);
  const bool takes_planar = data_.met_late && !certain_.knows_scale();
  int count = 0;
  for (int k = 0; k < features && count < capacity; ++k) {
    const int i = (from + k) % features;
    Mat3 covariance;
    const bool is_planar = takes_planar && is_on_found_plane(i);
    if ((!is_planar && !certain_.is_settled(i)) ||
        !is_before_wall(filter_, map_, plane_entry, filter_.point(map_.features[i].slot)))
      continue;
    if (is_planar || certain_.is_certain(i, &covariance)) slots[count++] = map_.features[i].slot;
  }
  return count;
}

bool WallFolding::may_set_scale(int plane_entry) const {
  if (certain_.knows_scale()) return true;
  const Vec3 c_W = camera_at(filter_.state(), Scalar(0)).p_W;
  int before_this = 0, before_other[kMaxPlanes] = {};
  for (int i = 0; i < map_.features.capacity(); ++i) {
    if (!certain_.is_settled(i)) continue;
    Scalar range = 0;
    const int first = first_wall(filter_, map_, c_W, filter_.point(map_.features[i].slot) - c_W, &range);
    if (first == plane_entry)
      ++before_this;
    else if (first >= 0)
      ++before_other[first];
  }
  for (const int other : before_other)
    if (other > before_this) return false;
  return true;
}

unsigned WallFolding::find_consensus(int plane_entry, const int* slots, int count, int* size) {
  const FoldRule rule = fold_rule(settings_, map_.planes[plane_entry]);
  const Scalar noise = rule.roughness * rule.roughness;
  const Scalar max_variance = settings_.plane_distance * settings_.plane_distance + noise;
  DistanceMeasurement z[Filter::kMaxFolded];
  filter_.begin_distances(map_.planes[plane_entry].slot, slots, count, noise, z);
  const auto S = [&](int i, int j) {
    return filter_.blocks().innovation_of<1>(i, j)(0, 0) + (i == j ? noise : Scalar(0));
  };
  const auto limit = [&](int) { return max_variance; };
  const auto r = [&](int j) { return -z[j].predicted(0); };
  return find_wall_consensus(count, r, S, rule.gate, limit, &data_.random, size);
}

void WallFolding::fold_by_consensus(int plane_entry) {
  int slots[Filter::kMaxFolded], chosen[Filter::kMaxFolded];
  const int limit = std::min(Filter::kMaxFolded, settings_.max_observations);
  if (map_.planes[plane_entry].doubted || !may_set_scale(plane_entry)) return;
  const int count = list_before_wall(plane_entry, slots, limit);
  if (count <= settings_.plane_min_points) return;
  int size;
  const unsigned consensus = find_consensus(plane_entry, slots, count, &size);
  if (size <= settings_.plane_min_points || kMinOnWall * size < count) return;
  size = 0;
  for (int j = 0; j < count; ++j)
    if ((consensus >> j & 1u) != 0) chosen[size++] = slots[j];
  unsigned char folded[Filter::kMaxFolded];
  if (filter_.fold(map_.planes[plane_entry].slot, chosen, size, fold_rule(settings_, map_.planes[plane_entry]),
                   folded) == 0)
    return;
  for (int j = 0; j < size; ++j)
    if (folded[j] != 0) support(filter_, map_, plane_entry, chosen[j]);
}

}  // namespace pf
