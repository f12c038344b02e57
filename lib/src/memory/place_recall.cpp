#include "memory/place_recall.h"

#include <algorithm>

#include "base/table_entries.h"
#include "geometry/so3.h"
#include "memory/tuning.h"

namespace pf {
namespace {

/// Those that are not there yet.
void add_points(const PlaceSearch& search, const KeptPlace& place, PlaceMatches* out) {
  for (int i = 0; i < place.count; ++i) {
    const PlacePoint& point = place.point[i];
    if (out->has(point.id)) continue;
    const int corner = search.corner_of(point.descriptor);
    if (corner >= 0) out->add(point.id, place.position_W(i), search.pixel(corner));
  }
}

Scalar median_distance(const PlaceMatches& matches, const Vec3& from_W) {
  Scalar distance[PlaceMatches::kMax];
  for (int i = 0; i < matches.count; ++i) distance[i] = (matches.point[i].m - from_W).norm();
  std::nth_element(distance, distance + matches.count / 2, distance + matches.count);
  return distance[matches.count / 2];
}

}  // namespace

void collect_place(const PlaceSearch& search, const PlaceTable& places, int p, PlaceMatches* out) {
  const KeptPlace& place = places[p];
  add_points(search, place, out);
  for (const int other : used_entries(places))
    if (other != p && view_distance2(place.q_WK, place.p_WK, place.depth, places[other].q_WK, places[other].p_WK,
                                     places[other].depth) < tuning::place::kNear * tuning::place::kNear)
      add_points(search, places[other], out);
}

bool PlaceRecall::find_pose_of(const Camera& camera, const PlaceSource& source, const PlaceMatches& matches,
                               Recalled* out) {
  if (matches.count < tuning::place_search::kMinMatches) return false;
  out->pose = PoseEstimate();
  out->pose.q_WC = source.q_WK;
  out->pose.p_WC = source.p_WK;
  out->inliers = search_.find_pose_of(camera, matches, &out->pose);
  out->place = source.id;
  out->depth = median_distance(matches, out->pose.p_WC);
  return out->inliers > 0;
}

/// Whether two places say that the camera is in two places.
bool PlaceRecall::is_apart(const Recalled& a, const Recalled& b, Scalar apart) {
  return log_so3(a.pose.q_WC * b.pose.q_WC.conjugate()).norm() > apart ||
         (a.pose.p_WC - b.pose.p_WC).norm() > apart * std::min(a.depth, b.depth);
}

}  // namespace pf
