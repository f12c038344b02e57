#include "keyframe_slam/map/keyframe_map.h"

#include <algorithm>

#include "frame/feature_upkeep.h"
#include "frame/tuning.h"
#include "keyframe_slam/map/rows.h"
#include "keyframe_slam/map/tuning.h"

namespace pf {

using namespace tuning::keyframe_map;

bool KeyframeMap::layout(Arena& arena) {
  const int points = settings_.max_features;
  point_ = arena.take<KeyframePoint>(static_cast<std::size_t>(points));
  scratch_ = arena.take<Scalar>(static_cast<std::size_t>(points));
  return keyframes.layout(arena, kKeyframes, points);
}

void KeyframeMap::init() {
  lens_.init(settings_.camera, settings_.lens);
  keyframes.init();
  for (int i = 0; i < capacity(); ++i) point_[i] = KeyframePoint();
}

void KeyframeMap::clear() {
  frame_.forget_all();
  map_.features.clear();
  map_.planes.clear();
  init();
}

HostPixel KeyframeMap::host_pixel(int i) const {
  HostPixel host = {Vec2::Zero(), false};
  host.given = !map_.features[i].is_target && project(camera(), point_[i].ray_K, &host.pixel);
  return host;
}

void KeyframeMap::move_lens(const Camera& camera) {
  for (int i = 0; i < capacity(); ++i) {
    if (!used(i)) continue;
    const HostPixel host = host_pixel(i);
    if (host.given) unproject(camera, host.pixel, &point_[i].ray_K);
  }
  lens_.move(camera);
}

int KeyframeMap::placed() const {
  int placed = 0;
  for (int i = 0; i < capacity(); ++i) placed += used(i) && point_[i].has_depth ? 1 : 0;
  return placed;
}

///   p = c + r / rho:   Sigma = r rᵀ var(rho) / rho^4 + (I - r rᵀ) sigma_b² / rho²
Mat3 KeyframeMap::covariance(int i) const {
  const KeyframePoint& point = point_[i];
  const Vec3 ray = ray_W(i);
  const Scalar depth = 1 / point.rho;
  const Scalar across = tuning::noise::kReferenceSigma / camera().fx * depth;
  const Scalar along = point.variance * depth * depth * depth * depth;
  return along * ray * ray.transpose() + across * across * (Mat3::Identity() - Mat3(ray * ray.transpose()));
}

BlockKind KeyframeMap::kind(int i) const {
  if (!point_[i].has_depth) return BlockKind::kInverseDepth;
  return point_[i].plane >= 0 ? BlockKind::kPlanePoint : BlockKind::kPoint;
}

Scalar KeyframeMap::median_depth(const Quat& q_WC, const Vec3& p_W) const {
  const Vec3 forward = q_WC.toRotationMatrix().col(2);
  int count = 0;
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    if (match.feature < 0 || match.status != MatchStatus::kInlier || !point_[match.feature].has_depth) continue;
    if (count < capacity()) scratch_[count++] = forward.dot(position(match.feature) - p_W);
  }
  if (count == 0) return 0;
  std::nth_element(scratch_, scratch_ + count / 2, scratch_ + count);
  return scratch_[count / 2];
}

int KeyframeMap::add(int host, const Vec2& pixel) {
  Vec3 ray_C;
  if (!unproject(camera(), pixel, &ray_C)) return -1;
  if (map_.features.count() >= capacity()) {
    const int worst = map_.features.least_useful(frame_.report.t_ns);
    if (worst < 0) return -1;
    drop(worst);
  }
  const int i = map_.features.add(0);
  if (i < 0) return -1;
  Feature& f = map_.features[i];
  f.observations = f.attempts = 1;
  f.last_seen_ns = frame_.report.t_ns;
  const Keyframe& keyframe = keyframes[host];
  KeyframePoint& point = point_[i];
  point = KeyframePoint();
  point.host = host;
  point.ray_K = ray_C.normalized();
  point.faces_host = true;
  point.pixel = pixel;
  point.seen_from = {keyframe.q_WC, keyframe.p_W};
  keyframes.forget_point(i);
  keyframes.set_pixel(host, i, pixel);
  ++frame_.report.new_features;
  return i;
}

int KeyframeMap::add_placed(int host, const Vec3& p_W) {
  const Keyframe& keyframe = keyframes[host];
  const Vec3 at = keyframe.q_WC.conjugate() * (p_W - keyframe.p_W);
  Vec2 pixel;
  if (!project(camera(), at, &pixel)) return -1;
  const int i = add(host, pixel);
  if (i < 0) return -1;
  place(i, p_W);
  return i;
}

void KeyframeMap::place(int i, const Vec3& p_W) {
  KeyframePoint& point = point_[i];
  const Keyframe& host = keyframes[point.host];
  const Vec3 at = host.q_WC.conjugate() * (p_W - host.p_W);
  point.ray_K = at.normalized();
  point.rho = 1 / at.norm();
  point.has_depth = true;
}

void KeyframeMap::drop(int i) {
  frame_.forget(i);
  map_.features.remove(i);
  point_[i] = KeyframePoint();
  keyframes.forget_point(i);
  ++frame_.report.evicted;
}

void KeyframeMap::move_views(const CameraView& newest_before) {
  const Keyframe& newest = keyframes[keyframes.newest()];
  const Quat q = newest.q_WC * newest_before.q_WC.conjugate();
  for (int i = 0; i < capacity(); ++i) {
    if (!used(i) || point_[i].has_depth) continue;
    CameraView& seen_from = point_[i].seen_from;
    seen_from.c_W = newest.p_W + q * (seen_from.c_W - newest_before.c_W);
    seen_from.q_WC = (q * seen_from.q_WC).normalized();
  }
}

void KeyframeMap::drop_failing() {
  for (int i = 0; i < capacity(); ++i) {
    if (!used(i) || map_.features[i].is_target) continue;
    const KeyframePoint& point = point_[i];
    if (fails_too_often(map_.features[i]) || (point.has_depth && !(point.rho > Scalar(0)))) drop(i);
  }
}

int KeyframeMap::add_keyframe(std::int64_t t_ns, const Quat& q_WC, const Vec3& p_W) {
  if (keyframes.count() >= keyframes.capacity()) remove_keyframe(least_useful_keyframe());
  const int k = keyframes.add(t_ns, q_WC, p_W);
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    if (match.feature >= 0 && match.status == MatchStatus::kInlier)
      keyframes.set_pixel(k, match.feature, point_[match.feature].pixel);
  }
  return k;
}

void KeyframeMap::correct_rows(int i, Scalar rho) {
  KeyframePoint& point = point_[i];
  const Vec3 at_W = position_at(i, rho);
  for (int k = 0; k < keyframes.capacity(); ++k) {
    const Keyframe& keyframe = keyframes[k];
    const BundlePixel& seen = keyframes.pixels(k)[i];
    if (!keyframes.used(k) || !seen.seen || !(keyframe.row_depth > Scalar(0))) continue;
    if (k != point.host && !keyframe.matches_by_motion) continue;
    Body body;
    body.q_WC = keyframe.q_WC;
    body.p_W = keyframe.p_W;
    body.v_W = keyframe.v_W;
    body.w_C = keyframe.w_C;
    const Vec3 d = at_W - keyframe.p_W;
    const Scalar w = 1 / keyframe.row_depth, w_now = 1 / d.norm();
    const Vec3 ray = d * w_now;
    const Vec2 before = seen.pixel();
    const Vec2 pixel = before + at_frame_time(camera(), body, ray + w_now * body.p_W, w_now, before) -
                       at_frame_time(camera(), body, ray + w * body.p_W, w, before);
    keyframes.set_pixel(k, i, pixel);
    Vec3 ray_C;
    if (k == point.host && unproject(camera(), pixel, &ray_C)) point.ray_K = ray_C.normalized();
  }
}

void KeyframeMap::keep_first_keyframe() {
  for (int k = 0; k < keyframes.capacity(); ++k) {
    if (!keyframes.used(k) || keyframes[k].number == 1) continue;
    for (int i = 0; i < capacity(); ++i)
      if (used(i) && point_[i].host == k) drop(i);
    keyframes.remove(k);
  }
}

/// The one that saw the fewest of the points that there are, and is not in the window; the older one among equals.
int KeyframeMap::least_useful_keyframe() const {
  int worst = -1, fewest = 0;
  for (int k = 0; k < keyframes.capacity(); ++k) {
    if (!keyframes.used(k) || keyframes[k].number > keyframes.numbered() - settings_.window_keyframes) continue;
    int seen = 0;
    for (int i = 0; i < capacity(); ++i) seen += keyframes.pixels(k)[i].seen ? 1 : 0;
    if (worst >= 0 && (seen > fewest || (seen == fewest && keyframes[k].number > keyframes[worst].number))) continue;
    worst = k;
    fewest = seen;
  }
  return worst;
}

/// Its points go to the newest keyframe that saw them; where there is none they are dropped.
void KeyframeMap::remove_keyframe(int k) {
  for (int i = 0; i < capacity(); ++i) {
    if (!used(i) || point_[i].host != k) continue;
    int host = -1;
    for (int other = 0; other < keyframes.capacity(); ++other) {
      if (other == k || !keyframes.used(other) || !keyframes.pixels(other)[i].seen) continue;
      if (host < 0 || keyframes[other].number > keyframes[host].number) host = other;
    }
    KeyframePoint& point = point_[i];
    const bool stays = host >= 0 && point.has_depth;
    const Vec3 at = stays ? Vec3(keyframes[host].q_WC.conjugate() * (position(i) - keyframes[host].p_W)) : Vec3::Zero();
    if (!stays || !(at.squaredNorm() > Scalar(0))) {
      drop(i);
      continue;
    }
    const Scalar rho = 1 / at.norm(), ratio = rho / point.rho;
    point.host = host;
    point.ray_K = at * rho;
    point.rho = rho;
    point.variance *= ratio * ratio * ratio * ratio;
    point.faces_host = false;
  }
  keyframes.remove(k);
}

}  // namespace pf
