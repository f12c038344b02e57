#include "keyframe_slam/walls/keyframe_walls.h"

#include <algorithm>
#include <cmath>

#include "base/limits.h"
#include "base/table_entries.h"
#include "frame/plane_settings.h"
#include "keyframe_slam/walls/tuning.h"
#include "map/wall_consensus.h"
#include "map/wall_votes.h"

namespace pf {
namespace {

constexpr int kMaxCandidates = 32;  // as many as a set has bits

/// Where the window has the planes of the table.
struct KeyframePlaneAt {
  const KeyframePlanes& planes;
  PlaneAt operator()(int k) const { return {planes.plane(k).frame}; }
};

}  // namespace

bool KeyframeWalls::layout(Arena& arena) {
  const int walls = kHasWalls ? settings_.max_planes : 0;
  compared_ = arena.take<SmallCount>(static_cast<std::size_t>(walls));
  measured_ = arena.take<MeasuredWall>(static_cast<std::size_t>(walls));
  return gauge_.layout(arena, walls);
}

void KeyframeWalls::init() {
  gauge_.init();
  random_ = 1;
  newest_compared_ = 0;
  std::fill(compared_, compared_ + gauge_.capacity(), SmallCount());
  for (const int k : used_entries(table_)) {
    if (!table_[k].known) continue;
    planes_.add_wall(k, planes_.plane(k).plan);
    gauge_.add(k, table_[k].prior_covariance());
  }
}

Status KeyframeWalls::add(const PlanePrior& prior, bool is_apart, std::uint32_t* id) {
  const int k = table_.add(0);
  if (k < 0) return Status::kFull;
  PlaneEntry& wall = table_[k];
  const Mat3 J = plane_error_jacobian();
  const Mat3 covariance = J.lazyProduct(prior.covariance).lazyProduct(J.transpose());
  wall.known = true;
  wall.apart = is_apart;
  for (int i = 0, n = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) wall.prior[n++] = covariance(i, j);
  wall.two_sided = prior.two_sided;
  wall.roughness = prior.roughness > Scalar(0) ? prior.roughness : settings_.fold.roughness;
  wall.plan = wall.seen = wall.support = prior.outline;
  planes_.add_wall(k, prior.frame);
  compared_[k] = 0;
  gauge_.add(k, covariance);
  *id = wall.id;
  return Status::kOk;
}

/// Each by itself, as a point that a place has brought back: with a depth that is known to a share. What the plan is off in all of them is
/// not in that, but in how well the map's size is known.
int KeyframeWalls::place_points(int least, Scalar* depth) {
  Scalar* const range = map_.scratch().number;
  const int newest = map_.keyframes.newest();
  const auto range_of = [&](int i) {
    const bool is_new = map_.point(i).host == newest && !map_.point(i).has_depth;
    const auto plan_of = [&](int k) { return planes_.plane(k).plan; };
    return is_new ? find_range_in_plan(table_, plan_of, map_.keyframes[newest].p_W, map_.ray_W(i)) : Scalar(0);
  };
  int count = 0;
  for (const int i : used_entries(map_)) {
    const Scalar r = range_of(i);
    if (r > Scalar(0)) range[count++] = r;
  }
  if (count < least) return 0;
  std::nth_element(range, range + count / 2, range + count);
  *depth = range[count / 2];
  for (const int i : used_entries(map_)) {
    const Scalar r = range_of(i), sigma = tuning::plane_walls::kOffWall / r;
    if (!(r > Scalar(0))) continue;
    KeyframePoint& point = map_.point(i);
    point.rho = 1 / r;
    point.variance = sigma * sigma;
    point.remembered = {point.rho, sigma};
    point.has_depth = true;
  }
  return count;
}

Scalar KeyframeWalls::find_factor(const Vec3& first_W, const Vec3& c_W) {
  using namespace tuning::start_before_walls;
  Scalar factor[kMaxRatios];
  int count = 0;
  for (const int k : used_entries(table_)) {
    if (!table_[k].apart) continue;
    for (int i = 0; i < map_.capacity() && count < kMaxRatios; ++i) {
      if (!map_.used(i) || !map_.point(i).has_depth || map_.feature(i).last_seen_ns != frame_.report.t_ns) continue;
      const KeyframePoint& point = map_.point(i);
      // Known better than the width within which points must agree.
      if (!(point.variance > Scalar(0)) || std::sqrt(point.variance) > (kOneWall - 1) * point.rho) continue;
      const Scalar u = factor_onto_wall(table_[k], planes_.plane(k).plan, first_W, c_W, map_.position(i));
      if (u > Scalar(0)) factor[count++] = u;
    }
  }
  return clear_factor(factor, count);
}

void KeyframeWalls::meet(const Mat6& first_pose, const Vec3& first_W) {
  begin(first_pose, first_W, tuning::start_before_walls::kOneWall - 1);
  for (const int k : used_entries(table_)) {
    if (!table_[k].known) continue;
    table_[k].apart = false;
    place(k);
  }
}

/// A wall that the map has not measured is where the gauge has it, which is known against the map as well as both are.
void KeyframeWalls::place(int k) {
  if (planes_.is_measured(k)) return;
  compared_[k] = 0;
  planes_.set_wall(k, gauge_.wall(k), gauge_.relative_covariance(k, planes_.plane(k).plan));
}

/// The pixels of a keyframe take part in as many adjustments as there are keyframes in one, so the n-th adjustment of a plane that has been
/// seen in n keyframes of K counts for the share of the newest: R = min(n, K) Sigma.
Similarity KeyframeWalls::compare(const KeyframeAdjustment& adjustment) {
  const AdjustmentShape& shape = adjustment.shape();
  const Keyframe& newest = map_.keyframes[map_.keyframes.newest()];
  const MapDrift drift = adjustment.drift();
  if (drift.any && newest.number != newest_compared_) gauge_.drift(drift.Q, newest.p_W, drift.sigma_scale);
  newest_compared_ = newest.number;
  int count = 0;
  for (const int k : used_entries(table_)) {
    const KeyframePlane& plane = planes_.plane(k);
    if (!is_used(k) || !plane.adjusted || !planes_.is_measured(k)) continue;
    const int seen_in = std::min<int>(++compared_[k], shape.keyframes);
    measured_[count++] = {k, plane.plan, plane.frame, static_cast<Scalar>(seen_in) * plane.covariance, true};
  }
  const Similarity T = gauge_.compare(measured_, count, tuning::plane_walls::kTripleGate);
  for (int c = 0; c < count; ++c)
    if (!measured_[c].fits) ++table_[measured_[c].wall].outliers;
  return T;
}

Similarity KeyframeWalls::maintain(const KeyframeAdjustment& adjustment, const CameraView& view) {
  for (const int k : used_entries(table_))
    if (is_used(k)) place(k);
  for (const int k : used_entries(table_))
    if (is_used(k) && !planes_.is_measured(k)) join(k, adjustment, view);
  Similarity T;
  for (const int k : used_entries(table_))
    if (table_[k].known && !table_[k].apart && judge(k, view, &T)) break;
  return T;
}

/// Of a point's distance from a plane. by_plane: its derivative by (a, b, h).
Scalar KeyframeWalls::distance_variance(int k, const Vec3& p_W, const Mat3& covariance, Vec3* by_plane) const {
  const KeyframePlane& plane = planes_.plane(k);
  const Vec3 n = plane.frame.R_WP.col(2), r = plane.frame.R_WP.transpose() * (p_W - plane.frame.o_W);
  *by_plane = Vec3(-r.x(), -r.y(), -1);
  const Scalar roughness = planes_.roughness_of(k);
  return n.dot(covariance * n) + roughness * roughness;
}

/// Points before a wall that agree that they lie on it.
void KeyframeWalls::join(int k, const KeyframeAdjustment& adjustment, const CameraView& view) {
  const KeyframePlane& plane = planes_.plane(k);
  int row[kMaxCandidates];
  Scalar r[kMaxCandidates], variance[kMaxCandidates];
  Vec3 J[kMaxCandidates];
  int count = 0;
  const int from = static_cast<int>(random_ % static_cast<std::uint32_t>(map_.capacity()));
  for (int n = 0; n < map_.capacity() && count < kMaxCandidates; ++n) {
    const int i = (from + n) % map_.capacity();
    Mat3 covariance;
    if (!planes_.is_certain(i, &covariance)) continue;
    const int other = map_.point(i).plane;
    const Vec3 p_W = map_.position(i);
    if ((other >= 0 && table_[other].known) ||
        !sees_through_outline(table_, KeyframePlaneAt{planes_}, k, view.c_W, p_W))
      continue;
    row[count] = i;
    r[count] = -plane_distance(plane.frame, Vec3::Zero(), p_W);
    // What keyframes may be off moves points of one wall against each other.
    const Scalar along = plane.frame.R_WP.col(2).dot(map_.ray_W(i)) / map_.point(i).rho;
    variance[count] = distance_variance(k, p_W, covariance, &J[count]) + along * along * adjustment.log_rho_variance(i);
    ++count;
  }
  if (count <= settings_.plane_min_points || join_found(k, view, row, count)) return;
  const auto S = [&](int i, int j) { return J[i].dot(plane.covariance * J[j]) + (i == j ? variance[i] : Scalar(0)); };
  const auto limit = [&](int j) {
    const Scalar near = distance_at(settings_, (map_.position(row[j]) - view.c_W).norm());
    const Scalar roughness = planes_.roughness_of(k), times = tuning::keyframe_walls::kKnownBetter;
    return std::max(near * near, J[j].dot(plane.covariance * J[j]) / (times * times)) + roughness * roughness;
  };
  int size = 0;
  const unsigned consensus = find_wall_consensus(
      count, [&](int j) { return r[j]; }, S, settings_.fold.gate, limit, &random_, &size);
  if (size <= settings_.plane_min_points || tuning::plane_walls::kMinOnWall * size < count) return;
  for (int j = 0; j < count; ++j)
    if ((consensus >> j & 1u) != 0) planes_.put_on(k, row[j]);
  planes_.fit(k, planes_.list_points(k));
  merge_emptied(k);
  settings_.hooks.say("wall ", table_[k].id, " is seen: ", size, " of ", count, " points before it lie on it");
}

/// A plane that was found, and that most of these points before a wall lie on, is the wall where the two fit:
///
///   zᵀ (C + Sigma)⁻¹ z < gate       z: (a, b, h) of the plane about the wall's frame, C of the wall against the map, Sigma of the plane
///
/// Its points before the wall lie on the wall from then on, and where that leaves it with few, it has merged into the wall.
bool KeyframeWalls::join_found(int k, const CameraView& view, const int* row, int count) {
  int on[kMaxPlanes] = {}, most = -1;
  for (int j = 0; j < count; ++j) {
    const int found = map_.point(row[j]).plane;
    if (found >= 0 && ++on[found] > (most < 0 ? 0 : on[most])) most = found;
  }
  if (most < 0 || on[most] <= settings_.plane_min_points || tuning::plane_walls::kMinOnWall * on[most] < count)
    return false;
  const KeyframePlane &wall = planes_.plane(k), &found = planes_.plane(most);
  Vec3 z;
  Mat3 J;
  SmallCholesky<3> cholesky;
  if (!(found.frame.R_WP.col(2).dot(wall.frame.R_WP.col(2)) > Scalar(0)) ||
      !reframe_plane(found.frame, Vec3::Zero(), wall.frame, &z, &J))
    return false;
  if (!cholesky.factor(wall.covariance + J.lazyProduct(found.covariance).lazyProduct(J.transpose()))) return false;
  if (!(z.dot(cholesky.solve<1>(z)) < tuning::plane_walls::kTripleGate)) return false;
  const KeyframePlaneAt where{planes_};
  for (const int i : used_entries(map_))
    if (map_.point(i).plane == most && map_.point(i).has_depth &&
        sees_through_outline(table_, where, k, view.c_W, map_.position(i)))
      planes_.put_on(k, i);
  planes_.fit(k, planes_.list_points(k));
  settings_.hooks.say("wall ", table_[k].id, " is seen: ", on[most], " of ", count,
                      " points before it lie on it, by plane ", table_[most].id);
  merge_emptied(k);
  return true;
}

/// Planes that were found, and have lost their points to this wall, have merged into it.
void KeyframeWalls::merge_emptied(int wall) {
  for (const int k : used_entries(table_)) {
    if (table_[k].known || table_[k].remembered || planes_.points_on(k) >= tuning::plane_lifecycle::kMinPoints)
      continue;
    if (table_[k].max_points < tuning::plane_lifecycle::kMinPoints) continue;
    const Vec3 middle = planes_.plane(k).frame.o_W;
    if (!outline_contains(table_[wall].support, plane_coordinates(planes_.plane(wall).frame, middle))) continue;
    if (!(planes_.plane(k).frame.R_WP.col(2).dot(planes_.plane(wall).frame.R_WP.col(2)) >
          tuning::plane_lifecycle::kMinNormalCosine))
      continue;
    for (const int i : used_entries(map_))
      if (map_.point(i).plane == k) planes_.put_on(wall, i);
    table_.remember_merge(table_[k].id, table_[wall].id);
    settings_.hooks.say("plane ", table_[k].id, " merged into wall ", table_[wall].id, ", which has its points");
    table_.remove(k);
  }
}

/// Returns whether the wall was rejected.
bool KeyframeWalls::judge(int k, const CameraView& view, Similarity* T) {
  PlaneEntry& wall = table_[k];
  const KeyframePlane& plane = planes_.plane(k);
  const Scalar side = plane_distance(plane.frame, Vec3::Zero(), view.c_W);
  WallCover cover(table_, KeyframePlaneAt{planes_}, k, map_.camera(), view);
  WallVotes votes;
  votes.on = planes_.points_on(k);
  for (const int i : used_entries(map_)) {
    Mat3 covariance;
    if (map_.feature(i).last_seen_ns != frame_.report.t_ns || map_.point(i).plane == k) continue;
    if (!planes_.is_certain(i, &covariance)) continue;
    const Vec3 p_W = map_.position(i);
    if (!sees_through_outline(table_, KeyframePlaneAt{planes_}, k, view.c_W, p_W)) continue;
    const Scalar d = plane_distance(plane.frame, Vec3::Zero(), p_W);
    Vec3 J;
    const Scalar of_point = distance_variance(k, p_W, covariance, &J);
    const Scalar variance = of_point + J.dot(plane.covariance * J);
    if (votes.add(side < Scalar(0) ? -d : d, variance, settings_.fold.gate)) cover.add(p_W);
  }
  votes.hide_most = cover.is_wide();
  if (wall.doubted) {
    if (!votes.uphold()) return false;
    wall.doubted = false;
    wall.outliers = 0;
    gauge_.add(k, tuning::plane_doubt::kDoubtedPrior * wall.prior_covariance());
    settings_.hooks.say("wall ", wall.id, " accepted again: ", votes.on, " points lie on it, ", votes.off, " do not");
    return false;
  }
  if (!votes.contradict(wall)) return false;
  settings_.hooks.say("wall ", wall.id, " rejected: ", votes.on, " points lie on it, ", votes.off, " do not (",
                      votes.behind, " behind it); ", static_cast<int>(wall.outliers), " left it");
  *T = reject(k);
  return true;
}

/// What its prior has told the map is taken back.
Similarity KeyframeWalls::reject(int k) {
  PlaneEntry& wall = table_[k];
  const Similarity T = gauge_.forget(k, wall.prior_covariance(), tuning::plane_doubt::kDoubtedPrior);
  planes_.clear_points(k);
  wall.doubted = true;
  wall.outliers = 0;
  const PlaneFrame& plan = planes_.plane(k).plan;
  planes_.set_wall(k, Vec3::Zero(), Mat3(wall.prior_covariance() + gauge_.plane_covariance(plan)));
  return T;
}

Mat3 KeyframeWalls::covariance(int wall) const {
  if (table_[wall].doubted) return table_[wall].prior_covariance();
  if (!planes_.is_measured(wall))
    return gauge_.has(wall) ? gauge_.wall_covariance(wall) : table_[wall].prior_covariance();
  const KeyframePlane& plane = planes_.plane(wall);
  return plane.covariance + gauge_.plane_covariance(plane.frame);
}

}  // namespace pf
