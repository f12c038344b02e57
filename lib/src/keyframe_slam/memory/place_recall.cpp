#include "keyframe_slam/memory/place_recall.h"

#include <algorithm>

#include "base/table_entries.h"
#include "frame/tuning.h"
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

bool PlaceRecall::layout(Arena& arena) {
  const bool is_asked_for = settings_.kept.places > 0;
  if (is_asked_for) corner_ = arena.take<std::int16_t>(static_cast<std::size_t>(settings_.max_features));
  return search_.layout(arena, is_asked_for);
}

bool PlaceRecall::find(const Tracker& tracker, Recall* best, Recall* rival) {
  *best = *rival = Recall();
  if (settings_.kept.places == 0) return false;
  search_.describe_image(tracker);
  match_window();
  Candidate candidate[kMaxCandidates];
  list(candidate);
  Recall found[kMaxCandidates];
  for (int c = 0; c < kMaxCandidates; ++c)
    if (try_candidate(candidate[c], &found[c]) && found[c].inliers > best->inliers) *best = found[c];
  for (const Recall& other : found)
    if (other.inliers > rival->inliers && is_apart(other, *best)) *rival = other;
  return best->inliers > 0;
}

void PlaceRecall::match_window() {
  for (int i = 0; i < map_.capacity(); ++i) {
    corner_[i] = -1;
    if (!map_.used(i) || !map_.point(i).has_depth || !map_.feature(i).has_appearance) continue;
    Descriptor descriptor;
    if (describe(map_.tables().appearance(i).patch, &descriptor))
      corner_[i] = static_cast<std::int16_t>(search_.corner_of(descriptor));
  }
}

/// Those with the most matches.
void PlaceRecall::list(Candidate* candidate) {
  const auto offer = [&](Candidate one) {
    PlaceMatches matches;
    one.matches = collect(one, &matches);
    for (int c = 0; c < kMaxCandidates; ++c)
      if (one.matches > candidate[c].matches) std::swap(one, candidate[c]);
  };
  for (const int k : used_entries(map_.keyframes)) offer({-1, k, 0});
  for (const int p : used_entries(map_.places))
    if (!map_.places[p].in_window) offer({p, -1, 0});
}

/// Points that the image may show, and where. Returns how many.
int PlaceRecall::collect(const Candidate& candidate, PlaceMatches* out) const {
  if (candidate.keyframe >= 0) {
    const BundlePixel* pixels = map_.keyframes.pixels(candidate.keyframe);
    for (int i = 0; i < map_.capacity(); ++i)
      if (corner_[i] >= 0 && pixels[i].seen) out->add(map_.feature(i).id, map_.position(i), search_.pixel(corner_[i]));
    return out->count;
  }
  const KeptPlace& place = map_.places[candidate.place];
  add_points(place, out);
  for (const int p : used_entries(map_.places)) {
    const KeptPlace& other = map_.places[p];
    if (p != candidate.place && view_distance2(place.q_WK, place.p_WK, place.depth, other.q_WK, other.p_WK,
                                               other.depth) < tuning::place::kNear * tuning::place::kNear)
      add_points(other, out);
  }
  return out->count;
}

/// Those that are not there yet.
void PlaceRecall::add_points(const KeptPlace& place, PlaceMatches* out) const {
  for (int i = 0; i < place.count; ++i) {
    const PlacePoint& point = place.point[i];
    if (out->has(point.id)) continue;
    const int corner = search_.corner_of(point.descriptor);
    if (corner >= 0) out->add(point.id, place.position_W(i), search_.pixel(corner));
  }
}

bool PlaceRecall::try_candidate(const Candidate& candidate, Recall* out) {
  if (candidate.matches < tuning::place_search::kMinMatches) return false;
  PlaceMatches matches;
  collect(candidate, &matches);
  PoseEstimate pose;
  pose.q_WC = candidate.place >= 0 ? map_.places[candidate.place].q_WK : map_.keyframes[candidate.keyframe].q_WC;
  pose.p_WC = candidate.place >= 0 ? map_.places[candidate.place].p_WK : map_.keyframes[candidate.keyframe].p_W;
  out->inliers = search_.find_pose_of(map_.camera(), matches, &pose);
  out->place = candidate.place >= 0 ? map_.places[candidate.place].id
                                    : static_cast<std::uint32_t>(map_.keyframes[candidate.keyframe].number);
  out->depth = median_distance(matches, pose.p_WC);
  out->pose.q_WC = pose.q_WC;
  out->pose.p_W = pose.p_WC;
  out->pose.P = pose.covariance;
  return out->inliers > 0;
}

/// Whether two places say that the camera is in two places.
bool PlaceRecall::is_apart(const Recall& a, const Recall& b) const {
  using namespace tuning::relocaliser;
  return log_so3(a.pose.q_WC * b.pose.q_WC.conjugate()).norm() > kAboutView ||
         (a.pose.p_W - b.pose.p_W).norm() > kAboutView * std::min(a.depth, b.depth);
}

}  // namespace pf
