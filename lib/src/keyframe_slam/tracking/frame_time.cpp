#include "keyframe_slam/tracking/frame_time.h"

#include "base/elapsed.h"
#include "keyframe_slam/map/rows.h"
#include "model/camera_at.h"

namespace pf {
namespace {

/// Whether this is the second sight of a point of the first keyframe.
bool is_seen_again(const KeyframeMap& map, const Match& match) {
  return map.feature(match.feature).observations == 1 && map.keyframes.is_first(map.point(match.feature).host);
}

/// Of a point's pixel since it was last accepted [px/s].
Vec2 image_motion(const KeyframeMap& map, const Match& match, std::int64_t t_ns) {
  const KeyframePoint& point = map.point(match.feature);
  const Feature& f = map.feature(match.feature);
  const Scalar tau = row_time(map.camera(), match.measured.y());
  const Scalar before = is_seen_again(map, match) ? row_time(map.camera(), point.pixel.y()) : Scalar(0);
  const Scalar dt = static_cast<Scalar>(seconds(elapsed_ns(f.last_seen_ns, t_ns))) + tau - before;
  return dt > Scalar(0) ? Vec2((match.measured - point.pixel) / dt) : Vec2(Vec2::Zero());
}

void correct_first_pixel(const Match& match, std::int64_t t_ns, KeyframeMap* map) {
  KeyframePoint& point = map->point(match.feature);
  const Vec2 first = point.pixel - row_time(map->camera(), point.pixel.y()) * image_motion(*map, match, t_ns);
  Vec3 ray_C;
  if (!unproject(map->camera(), first, &ray_C)) return;
  map->keyframes.set_pixel(point.host, match.feature, first);
  if (!map->feature(match.feature).is_target) point.ray_K = ray_C.normalized();
}

}  // namespace

Vec2 match_at_frame_time(const KeyframeMap& map, const Match& match, const PosePrior& at, Scalar depth) {
  if (!has_rows(map.camera())) return match.measured;
  const KeyframePoint& point = map.point(match.feature);
  const Scalar rho = point.has_depth ? point.rho : 1 / depth;
  return at_frame_time(map.camera(), at.body(), map.ray_W(match.feature) + rho * map.keyframes[point.host].p_W, rho,
                       match.measured);
}

Vec2 followed_at_frame_time(const KeyframeMap& map, const Match& match, std::int64_t t_ns) {
  if (!has_rows(map.camera())) return match.measured;
  return match.measured - row_time(map.camera(), match.measured.y()) * image_motion(map, match, t_ns);
}

void accept_match(const CameraView& seen_from, const Vec2& pixel, std::int64_t t_ns, KeyframeMap* map, Match* match) {
  match->status = MatchStatus::kInlier;
  Feature& f = map->feature(match->feature);
  if (has_rows(map->camera()) && is_seen_again(*map, *match)) correct_first_pixel(*match, t_ns, map);
  count_frame(&f.observations);
  f.rejections = 0;
  f.last_seen_ns = t_ns;
  KeyframePoint& point = map->point(match->feature);
  point.pixel = pixel;
  point.seen_from = seen_from;
}

}  // namespace pf
