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
  age_ = 0;
  estimate_share();
}

bool FixedFeatures::note(const Camera& camera, const Frame& frame, FeatureTable* features) {
  Quat q_before_now;
  bool is_fixed = false;
  if (has_reference(frame)) {
    ++age_;
    if (!find_turn(camera, frame, &q_before_now)) return false;
    weigh(camera, q_before_now, frame);
    estimate_share();
    const int fixed = mask_fixed(frame, features);
    is_fixed = fixed > 0 && kDiscredits * fixed >= frame.report.inliers;
  }
  keep_reference(frame);
  return is_fixed;
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

void FixedFeatures::keep_reference(const Frame& frame) {
  age_ = 1;
  for (int i = 0; i < capacity_; ++i) entry_[i].u = kNowhere;
  for (int t = 0; t < frame.match_count(); ++t) {
    const Match& match = frame.match(t);
    if (!is_found(match)) continue;
    Entry& entry = entry_[match.feature];
    const std::uint16_t id = static_cast<std::uint16_t>(match.id);
    const Vec2 at = kPerPixel * match.measured;
    if (entry.id != id) entry = {id, kNowhere, 0, 0};
    if (!(at.x() >= 0 && at.y() >= 0 && at.x() < kNowhere && at.y() < kNowhere)) continue;
    entry.u = static_cast<std::uint16_t>(at.x());
    entry.v = static_cast<std::uint16_t>(at.y());
  }
}

/// Whether the pose of the frame explains what has moved: most of that are its inliers.
bool FixedFeatures::is_explained(const Frame& frame) const {
  int moved = 0, explained = 0;
  for (int t = 0; t < frame.match_count(); ++t) {
    Vec2 pixel;
    const Match& match = frame.match(t);
    if (!before(match, &pixel) || (match.measured - pixel).squaredNorm() < kMinFlow * kMinFlow) continue;
    ++moved;
    explained += match.status == MatchStatus::kInlier ? 1 : 0;
  }
  return kMinMoved * explained > moved;
}

/// A point whose place is known, and which the frame's pose explains together with what has moved, stands still because it is far away and
/// the camera does not rotate. One whose depth is open would follow what is fixed.
void FixedFeatures::weigh(const Camera& camera, const Quat& q_before_now, const Frame& frame) {
  const bool is_scene = is_explained(frame);
  for (int t = 0; t < frame.match_count(); ++t) {
    const Match& match = frame.match(t);
    Vec2 pixel, flow;
    if (!before(match, &pixel) || !flow_at(camera, q_before_now, pixel, &flow) ||
        flow.squaredNorm() < kMinFlow * kMinFlow / 4)
      continue;
    Entry& entry = entry_[match.feature];
    Scalar ratio = log_ratio(match.measured - pixel, flow);
    if (is_scene && match.status == MatchStatus::kInlier && match.kind == BlockKind::kPoint)
      ratio = std::min(ratio, Scalar(0));
    const Scalar evidence = static_cast<Scalar>(entry.evidence) / kPerOdds + ratio;
    entry.evidence = static_cast<std::int16_t>(kPerOdds * std::clamp(evidence, -kMost, kMost));
  }
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
