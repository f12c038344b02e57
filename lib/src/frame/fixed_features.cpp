#include "frame/fixed_features.h"

#include <algorithm>
#include <cmath>

#include "bundle/bearing.h"
#include "frame/tuning.h"
#include "geometry/so3.h"

namespace pf {

using namespace tuning::fixed_features;

namespace {

bool is_found(const Match& match) { return match.feature >= 0 && match.status != MatchStatus::kMissed; }

/// How far a pixel has moved if the camera has only rotated. False outside of the lens's domain, and where it has hardly moved: there
/// parallax may be as large.
bool flow_at(const Camera& camera, const Quat& q_before_now, const Vec2& before, Vec2* flow) {
  Vec3 ray;
  Vec2 now;
  if (!unproject(camera, before, &ray) || !project(camera, q_before_now.conjugate() * ray, &now)) return false;
  *flow = now - before;
  return flow->squaredNorm() >= kMinFlow * kMinFlow / 4;
}

/// Flow of a point between two poses.
bool flow_of(const Camera& camera, const CameraView& before, const CameraView& now, const Vec3& p_W, Vec2* flow) {
  Vec2 then, there;
  if (!project(camera, before.q_WC.conjugate() * (p_W - before.c_W), &then) ||
      !project(camera, now.q_WC.conjugate() * (p_W - now.c_W), &there))
    return false;
  *flow = there - then;
  return true;
}

/// Flow of a point at infinity between two poses, and its derivative by inverse depth.
bool flow_at_infinity(const Camera& camera, const CameraView& before, const CameraView& now, const Vec2& pixel,
                      Vec2* flow, Vec2* J_rho) {
  Vec3 ray;
  Vec2 z;
  Mat23 J;
  if (!unproject(camera, pixel, &ray) || !project(camera, now.q_WC.conjugate() * (before.q_WC * ray), &z, &J))
    return false;
  *flow = z - pixel;
  *J_rho = J.lazyProduct(now.q_WC.conjugate() * (before.c_W - now.c_W));
  return true;
}

/// ln of how much more likely a shift is of what is fixed than of the scene.
Scalar log_ratio(const Vec2& shift, const Vec2& flow) {
  const Scalar still = kStill * kStill;
  const Scalar scene = still + kParallax * kParallax * flow.squaredNorm();
  return std::log(scene / still) + ((shift - flow).squaredNorm() / scene - shift.squaredNorm() / still) / 2;
}

}  // namespace

bool FixedFeatures::layout(Arena& arena, int width, int height, int max_features) {
  capacity_ = max_features;
  entry_ = arena.take<Entry>(static_cast<std::size_t>(max_features));
  return mask_.layout(arena, width, height, kCell);
}

void FixedFeatures::init(const ImageMask* also) {
  std::fill(entry_, entry_ + capacity_, Entry());
  mask_.init();
  mask_.set_also(also);
  forget_view();
  age_ = 0;
  estimate_share();
}

bool FixedFeatures::note(const Camera& camera, const KnownScene* scene, Frame* frame, FeatureTable* features) {
  Quat q_before_now;
  bool is_fixed = false;
  if (has_reference(*frame)) {
    ++age_;
    Scalar rho2 = 0;
    const bool by_pose = scene != nullptr && has_view_ && is_explained(*scene, *frame, &rho2);
    const bool by_rotation = find_turn(camera, *frame, &q_before_now);
    if (!by_pose && !by_rotation) return false;
    for (int t = 0; t < frame->match_count(); ++t) {
      const Match& match = frame->match(t);
      Vec2 pixel, flow;
      Scalar open = 0;
      if (!before(match, &pixel)) continue;
      if (by_pose && match.id > last_young_ ? flow_of_scene(camera, *scene, rho2, match, pixel, &flow, &open)
                                            : by_rotation && flow_at(camera, q_before_now, pixel, &flow))
        weigh(match, log_ratio(match.measured - pixel, flow) + open);
    }
    estimate_share();
    const int fixed = mask_fixed(*frame, features);
    is_fixed = fixed > 0 && kDiscredits * fixed >= frame->report.inliers;
    frame->masked = mask_.share();
  }
  keep_reference(scene, *frame);
  return is_fixed;
}

void FixedFeatures::follow(const Similarity& T) {
  view_ = {(T.q * view_.q_WC).normalized(), T.of(view_.c_W)};
  const float scale = static_cast<float>(T.s);
  for (int i = 0; i < capacity_; ++i) {
    entry_[i].rho /= scale;
    entry_[i].weight *= scale * scale;
  }
}

/// The reference frame is not too old, and most of what is found now was in it.
bool FixedFeatures::has_reference(const Frame& frame) const {
  int found = 0, known = 0;
  for (int t = 0; t < frame.match_count(); ++t) {
    Vec2 pixel;
    found += is_found(frame.match(t)) ? 1 : 0;
    known += before(frame.match(t), &pixel) ? 1 : 0;
  }
  return age_ > 0 && age_ < kMaxAge && kMinMoved * known > found;
}

/// Where a feature was in the reference frame. False: it was not in it, or is not found now.
bool FixedFeatures::before(const Match& match, Vec2* pixel) const {
  if (!is_found(match)) return false;
  const Entry& entry = entry_[match.feature];
  *pixel = Vec2(static_cast<Scalar>(entry.u), static_cast<Scalar>(entry.v)) / kPerPixel;
  return entry.id == static_cast<std::uint16_t>(match.id) && entry.u != kNowhere;
}

/// Whether the frame's pose explains what has moved: most of that are its inliers, and enough of them have a known place. False where most
/// features have not moved.
bool FixedFeatures::is_explained(const KnownScene& scene, const Frame& frame, Scalar* rho2) {
  int found = 0, moved = 0, known = 0, explained = 0;
  std::uint32_t newest = 0;
  for (int t = 0; t < frame.match_count(); ++t) {
    Vec2 pixel;
    const Match& match = frame.match(t);
    if (!before(match, &pixel)) continue;
    ++found;
    newest = std::max(newest, match.id);
    if ((match.measured - pixel).squaredNorm() < kMinFlow * kMinFlow) continue;
    ++moved;
    if (match.status != MatchStatus::kInlier) continue;
    ++explained;
    if (match.kind == BlockKind::kInverseDepth) continue;
    ++known;
    *rho2 += 1 / (scene.place(scene.map, match.feature) - scene.view.c_W).squaredNorm();
  }
  if (kMinMoved * moved < found || kMinMoved * explained <= moved || known < kMinPixels) return false;
  *rho2 /= static_cast<Scalar>(known);
  if (last_young_ == 0) last_young_ = newest;
  return true;
}

/// Rotation since the reference frame that explains the features which have moved. False where most features have not moved, or do not
/// agree with one rotation.
///
///   sum w |pixel - project(R^T ray)|^2,   w = 1 / (1 + |r|^2 / (kParallax |d|)^2)
bool FixedFeatures::find_turn(const Camera& camera, const Frame& frame, Quat* q_before_now) const {
  *q_before_now = Quat::Identity();
  int found = 0, moved = 0, agree = 0;
  for (int round = 0; round < kRounds; ++round) {
    const Mat3 R_before_now = q_before_now->toRotationMatrix();
    Mat3 H = Mat3::Identity() * kRegularisation;
    Vec3 g = Vec3::Zero();
    found = moved = agree = 0;
    for (int t = 0; t < frame.match_count(); ++t) {
      const Match& match = frame.match(t);
      Vec2 pixel, z;
      Vec3 ray;
      Mat26 J;
      if (!before(match, &pixel)) continue;
      ++found;
      const Scalar shift2 = (match.measured - pixel).squaredNorm();
      if (shift2 < kMinFlow * kMinFlow || !unproject(camera, pixel, &ray) ||
          !project_bearing(camera, R_before_now, ray, Vec3::Zero(), Scalar(0), &z, &J))
        continue;
      ++moved;
      const Vec2 r = match.measured - z;
      const Scalar off = r.squaredNorm() / (kParallax * kParallax * shift2), w = 1 / (1 + off);
      agree += off < Scalar(1) ? 1 : 0;
      const Mat23 J_r = J.leftCols<3>();
      H += w * J_r.transpose().lazyProduct(J_r);
      g += w * J_r.transpose().lazyProduct(r);
    }
    if (kMinMoved * moved < found || moved < kMinPixels) return false;
    *q_before_now = (exp_so3(H.inverse().lazyProduct(g)) * *q_before_now).normalized();
  }
  return kMinMoved * agree >= found;
}

void FixedFeatures::keep_reference(const KnownScene* scene, const Frame& frame) {
  age_ = 1;
  has_view_ = scene != nullptr;
  if (has_view_) view_ = scene->view;
  for (int i = 0; i < capacity_; ++i) entry_[i].u = kNowhere;
  for (int t = 0; t < frame.match_count(); ++t) {
    const Match& match = frame.match(t);
    if (!is_found(match)) continue;
    Entry& entry = entry_[match.feature];
    const std::uint16_t id = static_cast<std::uint16_t>(match.id);
    const Vec2 at = kPerPixel * match.measured;
    if (entry.id != id) entry = {id, kNowhere, 0, 0, 0, 0};
    if (!(at.x() >= 0 && at.y() >= 0 && at.x() < kNowhere && at.y() < kNowhere)) continue;
    entry.u = static_cast<std::uint16_t>(at.x());
    entry.v = static_cast<std::uint16_t>(at.y());
  }
}

/// How far a point of the scene has moved since the reference frame, by the poses of both. Of a feature without a known place by the
/// inverse depth that suits all of its shifts d best, in infinity's flow m, with J = dz/drho and, before the first, the mean square rho2
/// of features with a known place:
///
///   rho = sum J . (d - m) / w,   w = kStill^2 / rho2 + sum |J|^2,   rho >= 0
///
/// open: 1/2 ln of how much this shift has added to w; by so much is it less likely that a point of unknown depth comes to be where it is.
bool FixedFeatures::flow_of_scene(const Camera& camera, const KnownScene& scene, Scalar rho2, const Match& match,
                                  const Vec2& before, Vec2* flow, Scalar* open) {
  if (match.kind != BlockKind::kInverseDepth)
    return flow_of(camera, view_, scene.view, scene.place(scene.map, match.feature), flow);
  Vec2 J;
  if (!flow_at_infinity(camera, view_, scene.view, before, flow, &J)) return false;
  Entry& entry = entry_[match.feature];
  const Scalar before_it = entry.weight > 0 ? static_cast<Scalar>(entry.weight) : kStill * kStill / rho2;
  const Scalar weight = before_it + J.squaredNorm();
  const Scalar along = before_it * static_cast<Scalar>(entry.rho) + J.dot(match.measured - before - *flow);
  const Scalar rho = std::max(Scalar(0), along / weight);
  if (!(before_it > 0) || !std::isfinite(weight) || !std::isfinite(rho)) return false;
  *open = std::log(weight / before_it) / 2;
  entry.rho = static_cast<float>(rho);
  entry.weight = static_cast<float>(weight);
  *flow += rho * J;
  return true;
}

void FixedFeatures::weigh(const Match& match, Scalar log_ratio) {
  if (!std::isfinite(log_ratio)) return;
  Entry& entry = entry_[match.feature];
  const Scalar evidence = static_cast<Scalar>(entry.evidence) / kPerOdds + std::clamp(log_ratio, -kMaxStep, kMaxStep);
  entry.evidence = static_cast<std::int16_t>(kPerOdds * std::clamp(evidence, -kMost, kMost));
}

/// Share of the features that are fixed:  (1 + sum p) / (kScene + sum (1 - p)),   p of log_odds() with the share before
void FixedFeatures::estimate_share() {
  Scalar fixed = 0, scene = 0;
  for (int i = 0; i < capacity_; ++i) {
    if (entry_[i].id == 0 || entry_[i].evidence == 0) continue;
    const Scalar p = 1 / (1 + std::exp(-log_odds(entry_[i])));
    fixed += p;
    scene += 1 - p;
  }
  prior_ = std::log((fixed + 1) / (kScene + scene));
}

/// Masks the surroundings of features that are fixed. Returns how many of them are inliers.
int FixedFeatures::mask_fixed(const Frame& frame, FeatureTable* features) {
  int fixed = 0;
  for (int t = 0; t < frame.match_count(); ++t) {
    const Match& match = frame.match(t);
    Vec2 pixel;
    if (!before(match, &pixel) || log_odds(entry_[match.feature]) < kFixed) continue;
    const int x = static_cast<int>(match.measured.x()), y = static_cast<int>(match.measured.y());
    mask_.add({x - kMargin, y - kMargin, 2 * kMargin, 2 * kMargin});
    (*features)[match.feature].log_odds = static_cast<float>(-log_odds(entry_[match.feature]));
    fixed += match.status == MatchStatus::kInlier ? 1 : 0;
  }
  return fixed;
}

}  // namespace pf
