#include "keyframe_slam/map/keyframe_upkeep.h"

#include "base/table_entries.h"
#include "belief/feature_belief.h"

namespace pf {
namespace {

/// The one that saw the fewest of the points that there are, and is not among the newest; the older one among equals.
int least_useful_keyframe(const KeyframeMap& map, int kept) {
  int worst = -1, fewest = 0;
  for (const int k : used_entries(map.keyframes)) {
    if (map.keyframes[k].number > map.keyframes.numbered() - kept) continue;
    int seen = 0;
    for (int i = 0; i < map.capacity(); ++i) seen += map.keyframes.pixels(k)[i].seen ? 1 : 0;
    if (worst >= 0 && (seen > fewest || (seen == fewest && map.keyframes[k].number > map.keyframes[worst].number)))
      continue;
    worst = k;
    fewest = seen;
  }
  return worst;
}

}  // namespace

int leaving_keyframe(const KeyframeMap& map, int kept) {
  return map.keyframes.count() < map.keyframes.capacity() ? -1 : least_useful_keyframe(map, kept);
}

void remove_keyframe(int k, KeyframeMap* map) {
  for (const int i : used_entries(*map)) {
    if (map->point(i).host != k) continue;
    int host = -1;
    for (int other = 0; other < map->keyframes.capacity(); ++other) {
      if (other == k || !map->keyframes.used(other) || !map->keyframes.pixels(other)[i].seen) continue;
      if (host < 0 || map->keyframes[other].number > map->keyframes[host].number) host = other;
    }
    KeyframePoint& point = map->point(i);
    const bool stays = host >= 0 && point.has_depth;
    const Vec3 at = stays ? Vec3(map->keyframes[host].q_WC.conjugate() * (map->position(i) - map->keyframes[host].p_W))
                          : Vec3::Zero();
    if (!stays || !(at.squaredNorm() > Scalar(0))) {
      map->drop(i);
      continue;
    }
    const Scalar rho = 1 / at.norm(), ratio = rho / point.rho;
    point.host = host;
    point.ray_K = at * rho;
    point.rho = rho;
    point.variance *= ratio * ratio * ratio * ratio;
    point.remembered = {point.remembered.mean * ratio, point.remembered.sigma * ratio * ratio};
    point.faces_host = false;
  }
  map->keyframes.remove(k);
}

int add_keyframe(const Frame& frame, const CameraView& view, int kept, KeyframeMap* map) {
  const int leaving = leaving_keyframe(*map, kept);
  if (leaving >= 0) remove_keyframe(leaving, map);
  const int k = map->keyframes.add(frame.report.t_ns, view.q_WC, view.c_W);
  for (int t = 0; t < frame.match_count(); ++t) {
    const Match& match = frame.match(t);
    if (match.feature >= 0 && match.status == MatchStatus::kInlier)
      map->keyframes.set_pixel(k, match.feature, map->point(match.feature).pixel);
  }
  return k;
}

void keep_first_keyframe(KeyframeMap* map) {
  for (const int k : used_entries(map->keyframes)) {
    if (map->keyframes.is_first(k)) continue;
    for (const int i : used_entries(*map))
      if (map->point(i).host == k) map->drop(i);
    map->keyframes.remove(k);
  }
}

void drop_failing(KeyframeMap* map) {
  for (const int i : used_entries(*map)) {
    if (map->feature(i).is_target) continue;
    const KeyframePoint& point = map->point(i);
    if (is_no_point(static_cast<Scalar>(map->feature(i).log_odds)) || (point.has_depth && !(point.rho > Scalar(0))))
      map->drop(i);
  }
}

void move_views(const CameraView& newest_before, KeyframeMap* map) {
  const Keyframe& newest = map->keyframes[map->keyframes.newest()];
  const Quat q = newest.q_WC * newest_before.q_WC.conjugate();
  for (const int i : used_entries(*map)) {
    if (map->point(i).has_depth) continue;
    CameraView& seen_from = map->point(i).seen_from;
    seen_from.c_W = newest.p_W + q * (seen_from.c_W - newest_before.c_W);
    seen_from.q_WC = (q * seen_from.q_WC).normalized();
  }
}

int num_placed(const KeyframeMap& map) {
  int placed = 0;
  for (int i = 0; i < map.capacity(); ++i) placed += map.used(i) && map.point(i).has_depth ? 1 : 0;
  return placed;
}

}  // namespace pf
