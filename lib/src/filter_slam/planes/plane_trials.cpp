#include "filter_slam/planes/plane_trials.h"

#include <algorithm>

#include "base/table_entries.h"
#include "filter_slam/planes/plane_points.h"
#include "frame/tuning.h"
#include "model/camera_at.h"

namespace pf {
namespace {

using namespace tuning::plane_keeper;

enum class TrialVerdict { kOpen, kThere, kElsewhere };

/// The pixel at which this frame has found a feature; null: it has not.
const Match* find_inlier(const Frame& frame, int feature) {
  for (int t = 0; t < frame.match_count(); ++t)
    if (frame.match(t).feature == feature && frame.match(t).status == MatchStatus::kInlier) return &frame.match(t);
  return nullptr;
}

/// What this frame's pixel of a feature says of the plane on which it began, against a depth that is kTrialDepth smaller or larger:
///
///   z nearer to pi(p) than to either of pi(p_1 + (1 +- kTrialDepth) (p - p_1)),   p_1: the camera's place when it began
///
/// kOpen: there is no pixel, or the three are less than kTrialPixels apart.
TrialVerdict judge_depth(const Filter& filter, const Map& map, const Frame& frame, int entry) {
  const Vec3 p_W = filter.point(map.features[entry].slot), first_W = map.first_view(entry).c_W;
  const Match* match = find_inlier(frame, entry);
  if (match == nullptr) return TrialVerdict::kOpen;
  const CameraAt camera = camera_of_row(filter.state(), filter.lens(), match->measured.y());
  const auto pixel = [&](Scalar depth, Vec2* at) {
    const Vec3 moved_W = first_W + depth * (p_W - first_W);
    return project(filter.lens(), Vec3(camera.q_WC.conjugate() * (moved_W - camera.p_W)), at);
  };
  Vec2 here, nearer, farther;
  if (!pixel(1, &here) || !pixel(1 - kTrialDepth, &nearer) || !pixel(1 + kTrialDepth, &farther))
    return TrialVerdict::kOpen;
  const Scalar apart2 = std::min((nearer - here).squaredNorm(), (farther - here).squaredNorm());
  if (apart2 <= kTrialPixels * kTrialPixels) return TrialVerdict::kOpen;
  const Scalar off2 = (match->measured - here).squaredNorm();
  const bool elsewhere =
      (match->measured - nearer).squaredNorm() < off2 || (match->measured - farther).squaredNorm() < off2;
  return elsewhere ? TrialVerdict::kElsewhere : TrialVerdict::kThere;
}

}  // namespace

void judge_trials(const Filter& filter, Map& map, const Frame& frame, FeatureKeeper& features) {
  for (const int i : used_entries(map.features)) {
    if (!map.features[i].on_trial) continue;
    Feature& f = map.features[i];
    const TrialVerdict verdict = judge_depth(filter, map, frame, i);
    if (f.rejections >= kTrialRejections || verdict == TrialVerdict::kElsewhere) {
      features.drop(&i, 1);
    } else if (f.failures == 0 && f.observations > kTrialMatches && verdict == TrialVerdict::kThere) {
      f.on_trial = false;
      const int entry = map.planes.entry_at(filter.state().plane_of(f.slot));
      if (entry >= 0) support(filter, map, entry, f.slot);
    }
  }
}

}  // namespace pf
