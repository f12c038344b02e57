#include "keyframe_slam/planes/plane_upkeep.h"

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

void PlaneUpkeep::maintain(const Vec3& viewer_W) {
  viewer_W_ = viewer_W;
  for (const int k : used_entries(table_)) {
    ++table_[k].age;
    if (!table_[k].counts()) continue;
    if (planes_.plane(k).adjusted)
      drop_distant_points(k);
    else if (!table_[k].known)
      refit(k);
    take_points(k);
    if (!table_[k].known) outline(k);
  }
  merge();
  dissolve_weak();
  discover();
}

///   d² < gate (nᵀ Sigma n + roughness² + variance of the plane there),   |d| < 2 D,   nᵀ Sigma n <= D²,   D: distance_at its range
///
/// A wall that the map has not measured may be farther off than that: which points lie on it is found jointly (keyframe_walls.h).
bool PlaneUpkeep::lies_on(int k, const Vec3& p_W, const Mat3& covariance) const {
  const KeyframePlane& plane = planes_.plane(k);
  const Vec3 n = plane.frame.R_WP.col(2);
  const Vec3 r = plane.frame.R_WP.transpose() * (p_W - plane.frame.o_W);
  const Vec3 J(-r.x(), -r.y(), -1);  // of the distance by (a, b, h)
  const Scalar of_point = n.dot(covariance * n), of_plane = J.dot(plane.covariance * J);
  const Scalar near = distance_at(settings_, (p_W - viewer_W_).norm()), limit = near * near;
  const Scalar roughness = planes_.roughness_of(k), noise = roughness * roughness;
  const Scalar d2 = r.z() * r.z();
  if (table_[k].known && of_point + of_plane > limit) return false;
  return d2 < tuning::keyframe_planes::kReach2 * limit && of_point <= limit &&
         d2 < settings_.fold.gate * (of_point + of_plane + noise);
}

/// Takes points off a plane that they have left, and lists the others. Returns how many stay.
int PlaneUpkeep::drop_distant_points(int k) {
  const PlaneFrame& frame = planes_.plane(k).frame;
  const int count = planes_.list_points(k);
  int kept = 0;
  for (int c = 0; c < count; ++c) {
    const Scalar near = distance_at(settings_, (planes_.points_W()[c] - viewer_W_).norm());
    if (std::abs(plane_distance(frame, Vec3::Zero(), planes_.points_W()[c])) > tuning::keyframe_planes::kOff * near) {
      map_.point(planes_.listed()[c].name).plane = -1;
      ++table_[k].outliers;
      continue;
    }
    planes_.listed()[kept].name = planes_.listed()[c].name;
    planes_.points_W()[kept++] = planes_.points_W()[c];
  }
  return kept;
}

/// Points that lie on the plane, near to what is known of it.
void PlaneUpkeep::take_points(int k) {
  const Scalar reach =
      table_[k].known ? Scalar(0)
                      : std::min(member::kReach * std::sqrt(outline_area(table_[k].support)), settings_.plane_radius);
  const KnownSurface target = surface_of_target(map_);
  const bool may_be_target = may_be_plane(target, planes_.plane(k).frame.R_WP.col(2));
  for (int i = 0; i < map_.capacity(); ++i) {
    Mat3 covariance;
    if (!planes_.is_certain(i, &covariance) || map_.point(i).plane >= 0) continue;
    const Vec3 p_W = map_.position(i);
    if (!may_be_target && explains(target, p_W, covariance, settings_.fold.roughness, settings_.fold.gate)) continue;
    if (outline_contains(table_[k].support, plane_coordinates(planes_.plane(k).frame, p_W), reach) &&
        lies_on(k, p_W, covariance))
      planes_.put_on(k, i);
  }
}

/// Extends what was seen of a plane by the points that are on it now.
void PlaneUpkeep::outline(int k) {
  const int count = planes_.list_points(k);
  Vec2 uv[kOutlineBatch];
  for (int c = 0; c < count;) {
    int batch = 0;
    while (c < count && batch < kOutlineBatch)
      uv[batch++] = plane_coordinates(planes_.plane(k).frame, planes_.points_W()[c++]);
    extend_outline(&table_[k].seen, uv, reject_isolated(uv, batch));
  }
}

/// Looks for one new plane among points that lie on none yet.
void PlaneUpkeep::discover() {
  const std::uint32_t search_number = searches_++;
  int count = 0;
  const KnownSurface target = surface_of_target(map_);
  const Scalar near = 2 * settings_.plane_distance;
  for (int i = 0; i < map_.capacity(); ++i) {
    if (map_.used(i) && map_.feature(i).was_missed)
      continue;  // what decides about whole planes was found when last looked for
    if (!planes_.is_certain(i, &planes_.listed()[count].covariance) || map_.point(i).plane >= 0) continue;
    const Vec3 p_W = map_.position(i);
    bool taken = false;
    for (int k = 0; k < table_.capacity() && !taken; ++k)
      taken =
          table_.used(k) && (!table_[k].known || planes_.is_measured(k)) &&
          std::abs(plane_distance(planes_.plane(k).frame, Vec3::Zero(), p_W)) < near &&
          outline_contains(table_[k].support, plane_coordinates(planes_.plane(k).frame, p_W), settings_.plane_radius);
    if (taken) continue;
    const Mat3& covariance = planes_.listed()[count].covariance;
    planes_.listed()[count].is_explained =
        explains(target, p_W, covariance, settings_.fold.roughness, settings_.fold.gate);
    planes_.listed()[count].p_W = p_W;
    planes_.listed()[count++].name = i;
  }
  if (count <= settings_.plane_min_points) return;
  PlaneSearchSettings search = plane_search_settings(settings_);
  search.known = &target;
  PlaneFit fit;
  int members[kMaxPlaneMembers];
  int number = 0;
  if (!search_plane(planes_.listed(), count, search, viewer_W_, search_number, &fit, members, &number)) return;
  for (int m = 0; m < number; ++m) members[m] = planes_.listed()[members[m]].name;
  const int k = table_.add(0);
  if (k < 0) return;
  planes_.add_found(k, fit.frame);
  for (int m = 0; m < number; ++m) planes_.put_on(k, members[m]);
  refit(k);
  outline(k);
  settings_.hooks.say("plane ", table_[k].id, " found: ", number, " points");
}

/// Whether the points that are listed are all inside of a wall's outline. What goes beyond it is not the wall alone.
bool PlaneUpkeep::is_inside(int wall, int count) const {
  for (int c = 0; c < count; ++c)
    if (!outline_contains(table_[wall].support, plane_coordinates(planes_.plane(wall).frame, planes_.points_W()[c])))
      return false;
  return true;
}

/// Of two planes the one with fewer points. A wall stays, and takes others from when on the map has measured it.
bool PlaneUpkeep::may_merge(int other, int k) const {
  if (k == other || !table_.used(k) || !table_.used(other) || table_[other].known) return false;
  return table_[k].known ? planes_.is_measured(k) : planes_.points_on(other) <= planes_.points_on(k);
}

/// Merges one plane into another that its points lie on as well.
void PlaneUpkeep::merge() {
  for (int k = 0; k < table_.capacity(); ++k)
    for (int other = 0; other < table_.capacity(); ++other) {
      if (!may_merge(other, k)) continue;
      const PlaneFrame &to = planes_.plane(k).frame, &from = planes_.plane(other).frame;
      if (to.R_WP.col(2).dot(from.R_WP.col(2)) < same::kMinNormalCosine) continue;
      const int count = planes_.list_points(other);
      int close = 0;
      for (int c = 0; c < count; ++c)
        close += std::abs(plane_distance(to, Vec3::Zero(), planes_.points_W()[c])) <
                         tuning::keyframe_planes::kOff * settings_.plane_distance
                     ? 1
                     : 0;
      if (count < same::kMinPoints || same::kPerOutlier * (count - close) > count) continue;
      if (table_[k].known && !is_inside(k, count)) continue;
      for (int c = 0; c < count; ++c) planes_.put_on(k, planes_.listed()[c].name);
      for (int i = 0; i < table_[other].seen.count && !table_[k].known; ++i) {
        const Vec2 uv = plane_coordinates(to, plane_point(from, Vec3::Zero(), table_[other].seen.uv[i]));
        extend_outline(&table_[k].seen, &uv, 1);
      }
      const std::uint32_t merged = table_[other].id;
      table_.remember_merge(merged, table_[k].id);
      table_.remove(other);
      if (!table_[k].known) refit(k);
      settings_.hooks.say("plane ", merged, " merged into plane ", table_[k].id, ": ", close, " of its ", count,
                          " points are near it");
      return;
    }
}

void PlaneUpkeep::dissolve_weak() {
  for (const int k : used_entries(table_)) {
    if (table_[k].known) continue;
    const int points = planes_.points_on(k);
    PlaneEntry& entry = table_[k];
    entry.max_points = std::max<int>(entry.max_points, points);
    const bool proven = entry.max_points > settings_.plane_min_points;
    if (entry.remembered && points == 0) continue;
    entry.weak = points < same::kMinPoints || !proven ? entry.weak + 1 : 0;
    if (entry.outliers > points || entry.weak > tuning::keyframe_planes::kMaxWeak) {
      planes_.clear_points(k);
      table_.remove(k);
    }
  }
}

}  // namespace pf
