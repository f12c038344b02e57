#include <algorithm>
#include <cmath>

#include "filter_slam/features/tuning.h"
#include "filter_slam/features/wall_rays.h"
#include "filter_slam/planes/plane_keeper.h"
#include "geometry/small_cholesky.h"
#include "model/camera_at.h"

/// Planes known beforehand: how they enter the map, and what is folded into them. Servant 2008, section 2.2
/// (lib/docs/walls.md).

namespace pf {
namespace {

using namespace tuning::plane_walls;

/// A number below limit; changes the generator's state.
int draw(std::uint32_t* state, int limit) {
  *state = *state * 1664525u + 1013904223u;
  return static_cast<int>((*state >> 16) % static_cast<std::uint32_t>(limit));
}

}  // namespace

Status PlaneKeeper::add_wall(const PlanePrior& prior, int reserved_rows, bool may_evict, std::int64_t not_since_ns,
                             std::uint32_t* id) {
  constexpr int kRows = 3;
  if (filter_.state().planes >= filter_.state().max_planes) return Status::kFull;
  if (filter_.room() < kRows + reserved_rows &&
      !(may_evict && features_.make_rows(kRows + reserved_rows, not_since_ns)))
    return Status::kFull;
  const Mat3 J = plane_error_jacobian();
  const Mat3 covariance = J.lazyProduct(prior.covariance).lazyProduct(J.transpose());
  const Scalar roughness = prior.roughness > Scalar(0) ? prior.roughness : settings_.fold.roughness;
  const int slot = filter_.add_known_plane(prior.frame, covariance, roughness);
  if (slot < 0) return Status::kFull;
  const int entry = map_.planes.add(slot);  // the table has as many rows as the filter has planes
  filter_.set_owner(slot, entry);
  PlaneEntry& wall = map_.planes[entry];
  wall.known = true;
  for (int i = 0, k = 0; i < kRows; ++i)
    for (int j = 0; j <= i; ++j) wall.prior[k++] = covariance(i, j);
  wall.two_sided = prior.two_sided;
  wall.roughness = roughness;
  wall.plan = wall.seen = wall.support = prior.outline;
  *id = wall.id;
  return Status::kOk;
}

FoldRule PlaneKeeper::fold_rule(int plane_entry) const {
  FoldRule rule = settings_.fold;
  if (map_.planes[plane_entry].known) rule.roughness = map_.planes[plane_entry].roughness;
  return rule;
}

/// Whether the camera sees a point inside the wall's outline, with no other wall between them. Where the point is along its ray does not
/// matter: the plan says what should be there.
bool PlaneKeeper::is_before_wall(int plane_entry, const Vec3& p_W) const {
  const Vec3 c_W = camera_at(filter_.state(), Scalar(0)).p_W;
  Scalar range = 0, nearest = 0;
  if (!meets_wall(filter_, map_, plane_entry, c_W, p_W - c_W, &range)) return false;
  const int first = first_wall(filter_, map_, c_W, p_W - c_W, &nearest);
  return first < 0 || first == plane_entry || range <= nearest;
}

bool PlaneKeeper::knows_scale() const {
  return scale_.parts > 0 && filter_.variance_of(scale_) < kKnownScale * kKnownScale;
}

/// Whether a point is one of a plane that was found, which cannot merge into a wall that came into view late while the scale is open: it is
/// where the wall is only in a map of the right size.
bool PlaneKeeper::is_on_found_plane(int entry) const {
  if (!map_.features.used(entry) || map_.features[entry].on_trial || map_.features[entry].rejections > 0) return false;
  const int slot = map_.features[entry].slot;
  if (!is_planar(filter_.state().block[slot].kind)) return false;
  const int plane = map_.planes.entry_at(filter_.state().plane_of(slot));
  return plane >= 0 && !map_.planes[plane].known;
}

/// Converged points before the wall that are known well enough, in random order. Returns how many.
int PlaneKeeper::list_before_wall(int plane_entry, int* slots, int capacity) {
  const int features = map_.features.capacity();
  const int from = draw(&data_.random, features);
  const bool takes_planar = data_.met_late && !knows_scale();
  int count = 0;
  for (int k = 0; k < features && count < capacity; ++k) {
    const int i = (from + k) % features;
    Mat3 covariance;
    const bool is_planar = takes_planar && is_on_found_plane(i);
    if ((!is_planar && !is_settled(i)) || !is_before_wall(plane_entry, filter_.point(map_.features[i].slot))) continue;
    if (is_planar || is_certain(i, &covariance)) slots[count++] = map_.features[i].slot;
  }
  return count;
}

/// Whether the world's scale is known, or this wall has as many points before it as any other. As long as the scale is not
/// known, points before a wall that is not there agree with it as well as with one that is, only in a world of another size; so the wall
/// that most points are before decides.
bool PlaneKeeper::may_set_scale(int plane_entry) const {
  if (knows_scale()) return true;
  const Vec3 c_W = camera_at(filter_.state(), Scalar(0)).p_W;
  int before_this = 0, before_other[kMaxOthers] = {};
  for (int i = 0; i < map_.features.capacity(); ++i) {
    if (!is_settled(i)) continue;
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

/// The largest set of these points (a bit each) that agree with each other, and with the wall's prior, that they lie on it. A wall that
/// may be tilted, and a world whose scale is hardly known, leave every single point's distance uncertain; given three of the points, those
/// of the others are known.
///
///   after a triple t:   r_j|t = r_j - S_jt S_tt^-1 r_t,   S_j|t = S_jj - S_jt S_tt^-1 S_tj
unsigned PlaneKeeper::find_wall_consensus(int plane_entry, const int* slots, int count, int* size) {
  const FoldRule rule = fold_rule(plane_entry);
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

void PlaneKeeper::meet_walls() {
  data_.met_late = true;
  for (int i = 0; i < map_.planes.capacity(); ++i) {
    if (!map_.planes.used(i) || map_.planes[i].known) continue;
    const int plane = map_.planes[i].slot;
    filter_.state().for_each_planar(plane, [&](int slot) {
      const int feature = filter_.state().block[slot].owner;
      if (map_.features[feature].on_trial || !filter_.unfold(slot, settings_.fold.roughness))
        features_.drop(&feature, 1);
    });
    filter_.remove(&plane, 1);
    map_.planes.remove(i);
  }
  for (int i = 0; i < map_.planes.capacity(); ++i) {
    if (!map_.planes.used(i)) continue;
    filter_.scale_row(&scale_);
    fold_by_consensus(i);
  }
}

/// Folds points onto a wall that none of them alone is known to lie on.
void PlaneKeeper::fold_by_consensus(int plane_entry) {
  int slots[Filter::kMaxFolded], chosen[Filter::kMaxFolded];
  const int limit = std::min(Filter::kMaxFolded, settings_.max_observations);
  if (map_.planes[plane_entry].doubted || !may_set_scale(plane_entry)) return;
  const int count = list_before_wall(plane_entry, slots, limit);
  if (count <= settings_.plane_min_points) return;
  int size;
  const unsigned consensus = find_wall_consensus(plane_entry, slots, count, &size);
  if (size <= settings_.plane_min_points || 2 * size < count) return;
  size = 0;
  for (int j = 0; j < count; ++j)
    if ((consensus >> j & 1u) != 0) chosen[size++] = slots[j];
  unsigned char folded[Filter::kMaxFolded];
  if (filter_.fold(map_.planes[plane_entry].slot, chosen, size, fold_rule(plane_entry), folded) == 0) return;
  for (int j = 0; j < size; ++j)
    if (folded[j] != 0) support(plane_entry, chosen[j]);
}

}  // namespace pf
