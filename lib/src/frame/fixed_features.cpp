#include "frame/fixed_features.h"

#include <algorithm>
#include <cmath>

#include "frame/tuning.h"
#include "track/image_rotation.h"

namespace pf {

using namespace tuning::fixed_features;

namespace {

bool is_found(const Match& match) { return match.feature >= 0 && match.status != MatchStatus::kMissed; }

/// How far a pixel has moved if the camera has only rotated. False outside of the lens's domain.
bool flow_at(const Camera& camera, const Quat& q_before_now, const Vec2& before, Vec2* flow) {
  Vec3 ray;
  Vec2 now;
  if (!unproject(camera, before, &ray) || !project(camera, q_before_now.conjugate() * ray, &now)) return false;
  *flow = now - before;
  return true;
}

/// ln of how much more likely a shift is of what is fixed than of the scene.
Scalar log_ratio(const Vec2& shift, const Vec2& flow) {
  const Scalar scene = kParallax * kParallax * flow.squaredNorm(), still = kStill * kStill;
  const Scalar ratio =
      std::log(scene / still) + ((shift - flow).squaredNorm() / scene - shift.squaredNorm() / still) / 2;
  return std::clamp(ratio, -kMaxStep, kMaxStep);
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
  has_reference_ = false;
  fixed_ = scene_ = 0;
}

bool FixedFeatures::note(const Camera& camera, const Pyramid& image, const Frame& frame) {
  if (has_reference_ && ++age_ < kEvery) return false;
  Thumbnail now;
  make_thumbnail(image, &now);
  ThumbnailMask masked;
  make_thumbnail_mask(image, &masked);
  Quat q_before_now;
  if (!has_reference_ || !find_rotation(camera, reference_, now, masked, &q_before_now)) {
    keep_reference(now, frame);
    return false;
  }
  Vec2 flow;
  const Vec2 centre(camera.cx, camera.cy);
  if (!flow_at(camera, q_before_now, centre, &flow)) return false;
  if (flow.squaredNorm() < kMinFlow * kMinFlow && age_ < kMaxAge) return false;
  const int fixed = flow.squaredNorm() < kMinFlow * kMinFlow ? 0 : weigh(camera, q_before_now, frame);
  keep_reference(now, frame);
  return fixed > 0 && kDiscredits * fixed >= frame.report.inliers;
}

/// Log-odds of a feature that has not been judged: by how many of those that were are fixed.
Scalar FixedFeatures::prior() const {
  return std::log(static_cast<Scalar>(fixed_ + 1) / (kScene + static_cast<Scalar>(scene_)));
}

void FixedFeatures::keep_reference(const Thumbnail& now, const Frame& frame) {
  reference_ = now;
  has_reference_ = true;
  age_ = 0;
  for (int i = 0; i < capacity_; ++i) entry_[i].u = kNowhere;
  for (int t = 0; t < frame.match_count(); ++t) {
    const Match& match = frame.match(t);
    if (!is_found(match)) continue;
    Entry& entry = entry_[match.feature];
    const std::uint16_t id = static_cast<std::uint16_t>(match.id);
    const Vec2 at = kPerPixel * match.measured;
    if (entry.id != id) entry = {id, kNowhere, 0, static_cast<std::int16_t>(kPerOdds * prior())};
    if (!(at.x() >= 0 && at.y() >= 0 && at.x() < kNowhere && at.y() < kNowhere)) continue;
    entry.u = static_cast<std::uint16_t>(at.x());
    entry.v = static_cast<std::uint16_t>(at.y());
  }
}

int FixedFeatures::weigh(const Camera& camera, const Quat& q_before_now, const Frame& frame) {
  int fixed = 0;
  for (int t = 0; t < frame.match_count(); ++t) {
    const Match& match = frame.match(t);
    if (!is_found(match)) continue;
    Entry& entry = entry_[match.feature];
    const Vec2 before = Vec2(static_cast<Scalar>(entry.u), static_cast<Scalar>(entry.v)) / kPerPixel;
    Vec2 flow;
    if (entry.id != static_cast<std::uint16_t>(match.id) || entry.u == kNowhere ||
        !flow_at(camera, q_before_now, before, &flow) || flow.squaredNorm() < kMinFlow * kMinFlow / 4)
      continue;
    const Scalar known = static_cast<Scalar>(entry.log_odds) / kPerOdds;
    const Scalar log_odds = known + log_ratio(match.measured - before, flow);
    entry.log_odds = static_cast<std::int16_t>(kPerOdds * std::clamp(log_odds, -kFixed, kFixed));
    const int x = static_cast<int>(match.measured.x()), y = static_cast<int>(match.measured.y());
    scene_ += log_odds <= -kFixed && known > -kFixed ? 1 : 0;
    if (log_odds < kFixed) continue;
    ++fixed_;
    mask_.add({x - kMargin, y - kMargin, 2 * kMargin, 2 * kMargin});
    fixed += match.status == MatchStatus::kInlier ? 1 : 0;
  }
  return fixed;
}

}  // namespace pf
