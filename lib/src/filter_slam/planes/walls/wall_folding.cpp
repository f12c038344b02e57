#include "filter_slam/planes/walls/wall_folding.h"

#include <algorithm>

#include "base/limits.h"
#include "filter_slam/features/tuning.h"
#include "filter_slam/features/wall_rays.h"
#include "filter_slam/planes/plane_points.h"
#include "geometry/small_cholesky.h"
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
  unsigned best = 0;
  *size = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    int t[3];
    for (int& member : t) member = draw(&data_.random, count);
    if (t[0] == t[1] || t[0] == t[2] || t[1] == t[2]) continue;
    Mat3 S_tt;
    Vec3 r_t;
    for (int a = 0; a < 3; ++a) {
      r_t(a) = -z[t[a]].predicted(0);
      for (int b = 0; b < 3; ++b) S_tt(a, b) = S(t[a], t[b]);
    }
    SmallCholesky<3> cholesky;
    if (!cholesky.factor(S_tt)) continue;
    const Vec3 weighted = cholesky.solve<1>(r_t);
    if (!(r_t.dot(weighted) < kTripleGate)) continue;
    unsigned inliers = 0;
    int found = 0;
    for (int j = 0; j < count; ++j) {
      bool is_inlier = j == t[0] || j == t[1] || j == t[2];
      if (!is_inlier) {
        const Vec3 S_jt(S(j, t[0]), S(j, t[1]), S(j, t[2]));
        const Scalar r = -z[j].predicted(0) - S_jt.dot(weighted);
        const Scalar variance = S(j, j) - S_jt.dot(cholesky.solve<1>(S_jt));
        is_inlier = variance <= max_variance && r * r < rule.gate * variance;
      }
      if (!is_inlier) continue;
      inliers |= 1u << j;
      ++found;
    }
    if (found <= *size) continue;
    *size = found;
    best = inliers;
  }
  return best;
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
