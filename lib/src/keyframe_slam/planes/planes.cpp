#include "keyframe_slam/planes/planes.h"

#include <algorithm>
#include <cmath>

#include "base/table_entries.h"
#include "frame/plane_settings.h"
#include "frame/start/start.h"
#include "frame/tuning.h"
#include "keyframe_slam/planes/tuning.h"

namespace pf {

namespace {

/// The surface of the target, by its points in the map.
KnownSurface surface_of_target(const KeyframeMap& map) {
  Vec3 points_W[Target::kMaxPoints];
  int count = 0;
  for (const int i : used_entries(map))
    if (map.feature(i).is_target && map.point(i).has_depth && count < Target::kMaxPoints)
      points_W[count++] = map.position(i);
  return known_surface(map.tables().target_normal_W, points_W, count, tuning::plane_keeper::kReach);
}

}  // namespace

namespace same = tuning::plane_lifecycle;
namespace member = tuning::plane_keeper;

bool KeyframePlanes::layout(Arena& arena) {
  const std::size_t points = static_cast<std::size_t>(settings_.max_features);
  plane_ = arena.take<KeyframePlane>(static_cast<std::size_t>(settings_.max_planes));
  candidate_ = arena.take<PlaneCandidate>(points);
  return arena.ok();
}

void KeyframePlanes::maintain(const Vec3& viewer_W) {
  viewer_W_ = viewer_W;
  for (const int k : used_entries(table_)) {
    ++table_[k].age;
    if (plane_[k].adjusted)
      drop_distant_points(k);
    else
      refit(k);
    plane_[k].adjusted = false;
    take_points(k);
    outline(k);
  }
  merge();
  dissolve_weak();
  discover(viewer_W);
}

/// Lists the points on a plane. Returns how many.
int KeyframePlanes::list_points(int k) {
  int count = 0;
  for (const int i : used_entries(map_)) {
    if (!map_.point(i).has_depth || map_.point(i).plane != k) continue;
    candidate_[count].name = i;
    points_W()[count++] = map_.position(i);
  }
  return count;
}

int KeyframePlanes::points_on(int k) const {
  int count = 0;
  for (int i = 0; i < map_.capacity(); ++i) count += map_.used(i) && map_.point(i).plane == k ? 1 : 0;
  return count;
}

/// Whether a point is known well enough to be put on a plane.
bool KeyframePlanes::is_settled(int i, Mat3* covariance) const {
  if (!map_.used(i) || !map_.point(i).has_depth || map_.point(i).plane >= 0) return false;
  const Feature& f = map_.feature(i);
  if (f.is_target || f.rejections > 0 || f.observations < member::kConverged) return false;
  if (!(map_.point(i).variance > Scalar(0))) return false;
  *covariance = map_.covariance(i);
  return covariance->trace() < settings_.fold_sigma * settings_.fold_sigma;
}

///   d² < gate (nᵀ Sigma n + roughness² + variance of the plane there),   |d| < 2 D,   nᵀ Sigma n <= D²,   D: distance_at its range
bool KeyframePlanes::lies_on(int k, const Vec3& p_W, const Mat3& covariance) const {
  const KeyframePlane& plane = plane_[k];
  const Vec3 n = plane.frame.R_WP.col(2);
  const Vec3 r = plane.frame.R_WP.transpose() * (p_W - plane.frame.o_W);
  const Vec3 J(-r.x(), -r.y(), -1);  // of the distance by (a, b, h)
  const Scalar of_point = n.dot(covariance * n), of_plane = J.dot(plane.covariance * J);
  const Scalar near = distance_at(settings_, (p_W - viewer_W_).norm()), limit = near * near;
  const Scalar noise = settings_.fold.roughness * settings_.fold.roughness;
  const Scalar d2 = r.z() * r.z();
  return d2 < tuning::keyframe_planes::kReach2 * limit && of_point <= limit &&
         d2 < settings_.fold.gate * (of_point + of_plane + noise);
}

/// Gives a plane another frame, with the first axis along the old one's, and its outlines in it.
void KeyframePlanes::set_frame(int k, const PlaneFrame& frame) {
  const PlaneFrame from = plane_[k].frame;
  plane_[k].frame = frame;
  for (PlaneOutline* known : {&table_[k].seen, &table_[k].support})
    for (int i = 0; i < known->count; ++i)
      known->uv[i] = plane_coordinates(frame, plane_point(from, Vec3::Zero(), known->uv[i]));
}

bool KeyframePlanes::take_adjusted(int k, const Vec3& x, const Mat3& covariance) {
  const PlaneFrame& old = plane_[k].frame;
  PlaneFrame frame;
  Vec3 n, zero;
  Scalar d;
  Mat3 J;
  plane_normal(old, x, &n, &d);
  if (!(n.dot(old.R_WP.col(2)) > same::kMinNormalCosine)) return false;
  frame.o_W = plane_point(old, x, Vec2::Zero());
  frame.R_WP.col(0) = (old.R_WP.col(0) - n * n.dot(old.R_WP.col(0))).normalized();
  frame.R_WP.col(1) = n.cross(frame.R_WP.col(0));
  frame.R_WP.col(2) = n;
  if (!reframe_plane(old, x, frame, &zero, &J)) return false;
  set_frame(k, frame);
  plane_[k].covariance = J.lazyProduct(covariance).lazyProduct(J.transpose());
  plane_[k].adjusted = true;
  return true;
}

void KeyframePlanes::scale(Scalar s, const Vec3& c_W) {
  for (const int k : used_entries(table_)) {
    KeyframePlane& plane = plane_[k];
    plane.frame.o_W = c_W + s * (plane.frame.o_W - c_W);
    plane.covariance.row(2) *= s;
    plane.covariance.col(2) *= s;
    for (PlaneOutline* known : {&table_[k].seen, &table_[k].support})
      for (int i = 0; i < known->count; ++i) known->uv[i] *= s;
  }
}

/// Takes points off a plane that they have left, and lists the others. Returns how many stay.
int KeyframePlanes::drop_distant_points(int k) {
  const PlaneFrame& frame = plane_[k].frame;
  const int count = list_points(k);
  int kept = 0;
  for (int c = 0; c < count; ++c) {
    const Scalar near = distance_at(settings_, (points_W()[c] - viewer_W_).norm());
    if (std::abs(plane_distance(frame, Vec3::Zero(), points_W()[c])) > tuning::keyframe_planes::kOff * near) {
      map_.point(candidate_[c].name).plane = -1;
      ++table_[k].outliers;
      continue;
    }
    candidate_[kept].name = candidate_[c].name;
    points_W()[kept++] = points_W()[c];
  }
  return kept;
}

/// Fits a plane to its points again, without those that have left it.
///
///   covariance of (a, b, h) = sum J_i (Sigma_i + roughness² n nᵀ) J_iᵀ,   J_i of fit_plane_jacobian
void KeyframePlanes::refit(int k) {
  const PlaneFrame old = plane_[k].frame;
  const Vec3 n_old = old.R_WP.col(2);
  const int kept = drop_distant_points(k);
  PlaneFit fit;
  if (kept < same::kMinPoints || !fit_plane(points_W(), kept, old.o_W + n_old, &fit)) return;
  const Mat3 axes = fit.frame.R_WP;
  const Vec3 n = axes.col(2);
  if (!(n.dot(n_old) > same::kMinNormalCosine)) return;
  Mat3 P = Mat3::Zero();
  const Scalar roughness2 = settings_.fold.roughness * settings_.fold.roughness;
  for (int c = 0; c < kept; ++c) {
    const Mat3 J = fit_plane_jacobian(fit, points_W()[c]);
    const Mat3 S = map_.covariance(candidate_[c].name) + roughness2 * n * n.transpose();
    P += J.lazyProduct(S).lazyProduct(J.transpose());
  }
  PlaneFrame frame = fit.frame;
  frame.R_WP.col(0) = (old.R_WP.col(0) - n * n.dot(old.R_WP.col(0))).normalized();
  frame.R_WP.col(1) = n.cross(frame.R_WP.col(0));
  // (a, b) turn with the axes.
  Mat3 T = frame.R_WP.transpose() * axes;
  T.col(2).setZero();
  T.row(2).setZero();
  T(2, 2) = 1;
  plane_[k].covariance = T.lazyProduct(P).lazyProduct(T.transpose());
  set_frame(k, frame);
}

void KeyframePlanes::put_on(int k, int i) {
  map_.point(i).plane = static_cast<std::int8_t>(k);
  const Vec2 uv = plane_coordinates(plane_[k].frame, map_.position(i));
  extend_outline(&table_[k].support, &uv, 1);
}

/// Points that lie on the plane, near to what is known of it.
void KeyframePlanes::take_points(int k) {
  const Scalar reach = std::min(member::kReach * std::sqrt(outline_area(table_[k].support)), settings_.plane_radius);
  const KnownSurface target = surface_of_target(map_);
  const bool may_be_target = may_be_plane(target, plane_[k].frame.R_WP.col(2));
  for (int i = 0; i < map_.capacity(); ++i) {
    Mat3 covariance;
    if (!is_settled(i, &covariance)) continue;
    const Vec3 p_W = map_.position(i);
    if (!may_be_target && explains(target, p_W, covariance, settings_.fold.roughness, settings_.fold.gate)) continue;
    if (outline_contains(table_[k].support, plane_coordinates(plane_[k].frame, p_W), reach) &&
        lies_on(k, p_W, covariance))
      put_on(k, i);
  }
}

/// Extends what was seen of a plane by the points that are on it now.
void KeyframePlanes::outline(int k) {
  const int count = list_points(k);
  Vec2 uv[kOutlineBatch];
  for (int c = 0; c < count;) {
    int batch = 0;
    while (c < count && batch < kOutlineBatch) uv[batch++] = plane_coordinates(plane_[k].frame, points_W()[c++]);
    extend_outline(&table_[k].seen, uv, reject_isolated(uv, batch));
  }
}

/// Looks for one new plane among points that lie on none yet.
void KeyframePlanes::discover(const Vec3& viewer_W) {
  const std::uint32_t search_number = searches_++;
  int count = 0;
  const KnownSurface target = surface_of_target(map_);
  const Scalar near = 2 * settings_.plane_distance;
  for (int i = 0; i < map_.capacity(); ++i) {
    if (map_.used(i) && map_.feature(i).was_missed)
      continue;  // what decides about whole planes was found when last looked for
    if (!is_settled(i, &candidate_[count].covariance)) continue;
    const Vec3 p_W = map_.position(i);
    bool taken = false;
    for (int k = 0; k < table_.capacity() && !taken; ++k)
      taken = table_.used(k) && std::abs(plane_distance(plane_[k].frame, Vec3::Zero(), p_W)) < near &&
              outline_contains(table_[k].support, plane_coordinates(plane_[k].frame, p_W), settings_.plane_radius);
    if (taken) continue;
    const Mat3& covariance = candidate_[count].covariance;
    candidate_[count].is_explained = explains(target, p_W, covariance, settings_.fold.roughness, settings_.fold.gate);
    candidate_[count].p_W = p_W;
    candidate_[count++].name = i;
  }
  if (count <= settings_.plane_min_points) return;
  PlaneSearchSettings search = plane_search_settings(settings_);
  search.known = &target;
  PlaneFit fit;
  int members[kMaxPlaneMembers];
  int number = 0;
  if (!search_plane(candidate_, count, search, viewer_W, search_number, &fit, members, &number)) return;
  for (int m = 0; m < number; ++m) members[m] = candidate_[members[m]].name;
  const int k = table_.add(0);
  if (k < 0) return;
  plane_[k] = {fit.frame, Mat3::Identity() * (settings_.plane_distance * settings_.plane_distance), false};
  for (int m = 0; m < number; ++m) put_on(k, members[m]);
  refit(k);
  outline(k);
  settings_.hooks.say("plane ", table_[k].id, " found: ", number, " points");
}

/// Merges one plane into another that its points lie on as well.
void KeyframePlanes::merge() {
  for (int k = 0; k < table_.capacity(); ++k)
    for (int other = 0; other < table_.capacity(); ++other) {
      if (k == other || !table_.used(k) || !table_.used(other) || points_on(other) > points_on(k)) continue;
      const PlaneFrame &to = plane_[k].frame, &from = plane_[other].frame;
      if (to.R_WP.col(2).dot(from.R_WP.col(2)) < same::kMinNormalCosine) continue;
      const int count = list_points(other);
      int close = 0;
      for (int c = 0; c < count; ++c)
        close += std::abs(plane_distance(to, Vec3::Zero(), points_W()[c])) <
                         tuning::keyframe_planes::kOff * settings_.plane_distance
                     ? 1
                     : 0;
      if (count < same::kMinPoints || same::kPerOutlier * (count - close) > count) continue;
      for (int c = 0; c < count; ++c) put_on(k, candidate_[c].name);
      for (int i = 0; i < table_[other].seen.count; ++i) {
        const Vec2 uv = plane_coordinates(to, plane_point(from, Vec3::Zero(), table_[other].seen.uv[i]));
        extend_outline(&table_[k].seen, &uv, 1);
      }
      const std::uint32_t merged = table_[other].id;
      table_.remember_merge(merged, table_[k].id);
      table_.remove(other);
      refit(k);
      settings_.hooks.say("plane ", merged, " merged into plane ", table_[k].id, ": ", close, " of its ", count,
                          " points are near it");
      return;
    }
}

void KeyframePlanes::dissolve_weak() {
  for (const int k : used_entries(table_)) {
    const int points = points_on(k);
    PlaneEntry& entry = table_[k];
    entry.max_points = std::max<int>(entry.max_points, points);
    const bool proven = entry.max_points > settings_.plane_min_points;
    if (entry.remembered && points == 0) continue;
    entry.weak = points < same::kMinPoints || !proven ? entry.weak + 1 : 0;
    if (entry.outliers > points || entry.weak > tuning::keyframe_planes::kMaxWeak) dissolve(k);
  }
}

void KeyframePlanes::dissolve(int k) {
  for (const int i : used_entries(map_))
    if (map_.point(i).plane == k) map_.point(i).plane = -1;
  table_.remove(k);
}

}  // namespace pf
