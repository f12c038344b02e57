#include "memory/place_recall.h"

#include <algorithm>

#include "base/table_entries.h"
#include "geometry/so3.h"
#include "memory/tuning.h"

namespace pf {
namespace {

Scalar median_distance(const PlaceMatches& matches, const Vec3& from_W) {
  Scalar distance[PlaceMatches::kMax];
  for (int i = 0; i < matches.count; ++i) distance[i] = (matches.point[i].m - from_W).norm();
  std::nth_element(distance, distance + matches.count / 2, distance + matches.count);
  return distance[matches.count / 2];
}

}  // namespace

void ExplainedPoints::remove_from(PlaceMatches* matches) const {
  int kept = 0;
  for (int i = 0; i < matches->count; ++i) {
    if (std::find(id, id + count, matches->id[i]) != id + count) continue;
    matches->id[kept] = matches->id[i];
    matches->point[kept++] = matches->point[i];
  }
  matches->count = kept;
}

bool PlaceRecall::layout(Arena& arena, int places) {
  if (places > 0) corner_ = arena.take<std::int16_t>(static_cast<std::size_t>(places * KeptPlace::kMaxPoints));
  return search_.layout(arena, places > 0);
}

int PlaceRecall::least_matches() { return tuning::place_search::kMinMatches; }

void PlaceRecall::match_places(const PlaceTable& places) {
  for (const int p : used_entries(places))
    for (int i = 0; i < places[p].count; ++i)
      corner_[p * KeptPlace::kMaxPoints + i] =
          static_cast<std::int16_t>(search_.corner_of(places[p].point[i].descriptor));
}

/// Those that are not there yet.
void PlaceRecall::add_points(const PlaceTable& places, int p, PlaceMatches* out) const {
  const KeptPlace& place = places[p];
  for (int i = 0; i < place.count; ++i) {
    const int corner = corner_[p * KeptPlace::kMaxPoints + i];
    if (corner >= 0 && !out->has(place.point[i].id))
      out->add(place.point[i].id, place.position_W(i), search_.pixel(corner));
  }
}

void PlaceRecall::collect_place(const PlaceTable& places, int p, PlaceMatches* out) const {
  const KeptPlace& place = places[p];
  add_points(places, p, out);
  for (const int other : used_entries(places))
    if (other != p && place.map_id == places[other].map_id &&
        view_distance2(place.q_WK, place.p_WK, place.depth, places[other].q_WK, places[other].p_WK,
                       places[other].depth) < tuning::place::kNear * tuning::place::kNear)
      add_points(places, other, out);
}

void PlaceRecall::find_pose_of(const Camera& camera, const PlaceSource& source, const PlaceMatches& matches,
                               ExplainedPoints* explained, Recalled* out) {
  bool is_inlier[PlaceMatches::kMax];
  out->pose = PoseEstimate();
  out->pose.q_WC = source.q_WK;
  out->pose.p_WC = source.p_WK;
  out->inliers = search_.find_pose_of(camera, matches, &out->pose, is_inlier);
  out->place = source.id;
  out->depth = median_distance(matches, out->pose.p_WC);
  for (int i = 0; i < matches.count; ++i)
    if (out->inliers == 0 || is_inlier[i]) explained->add(matches.id[i]);
}

bool PlaceRecall::is_elsewhere(const Recalled& a, const Recalled& b) {
  return view_distance2(a.pose.q_WC, a.pose.p_WC, a.depth, b.pose.q_WC, b.pose.p_WC, b.depth) >=
         tuning::place::kNear * tuning::place::kNear;
}

/// Whether two places say that the camera is in two places.
bool PlaceRecall::is_apart(const Recalled& a, const Recalled& b, Scalar apart) {
  return log_so3(a.pose.q_WC * b.pose.q_WC.conjugate()).norm() > apart ||
         (a.pose.p_WC - b.pose.p_WC).norm() > apart * std::min(a.depth, b.depth);
}

}  // namespace pf
