#include "keyframe_slam/map/keyframe_map.h"

#include <algorithm>

#include "frame/feature_upkeep.h"
#include "frame/tuning.h"
#include "keyframe_slam/map/readout.h"
#include "keyframe_slam/map/rows.h"
#include "keyframe_slam/map/tuning.h"

namespace pf {

using namespace tuning::keyframe_map;

bool KeyframeMap::layout(Arena& arena) {
  const int points = settings_.max_features;
  point_ = arena.take<KeyframePoint>(static_cast<std::size_t>(points));
  scratch_.number = arena.take<Scalar>(static_cast<std::size_t>(points));
  scratch_.vector = arena.take<Vec3>(static_cast<std::size_t>(points));
  places.layout(arena, settings_.kept.places);
  return keyframes.layout(arena, kKeyframes, points);
}

void KeyframeMap::init() {
  clear();
  keyframes.init();
  places.clear();
}

void KeyframeMap::clear() {
  frame_.forget_all();
  map_.features.clear();
  map_.planes.keep_known();
  keyframes.begin_map();
  places.clear_present();
  lens_.init(settings_.camera, settings_.lens);
  for (int i = 0; i < capacity(); ++i) point_[i] = KeyframePoint();
}

HostPixel KeyframeMap::host_pixel(int i) const {
  HostPixel host = {Vec2::Zero(), false};
  host.given = !map_.features[i].is_target && project(camera(), point_[i].ray_K, &host.pixel);
  return host;
}

void KeyframeMap::move_lens(const Camera& camera) {
  if (lens_.rows().has_readout()) move_readout(camera.readout, settings_.start_depth, this);
  for (int i = 0; i < capacity(); ++i) {
    if (!used(i)) continue;
    const HostPixel host = host_pixel(i);
    if (host.given) unproject(camera, host.pixel, &point_[i].ray_K);
  }
  lens_.move(camera);
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
  Scalar* const depth = scratch_.number;
  int count = 0;
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    if (match.feature < 0 || match.status != MatchStatus::kInlier || !point_[match.feature].has_depth) continue;
    if (count < capacity()) depth[count++] = forward.dot(position(match.feature) - p_W);
  }
  if (count == 0) return 0;
  std::nth_element(depth, depth + count / 2, depth + count);
  return depth[count / 2];
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

}  // namespace pf
