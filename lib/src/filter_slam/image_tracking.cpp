#include "filter_slam/image_tracking.h"

#include "base/elapsed.h"
#include "frame/tuning.h"

namespace pf {

bool ImageTracking::layout(Arena& arena) {
  front_end_.layout(arena, settings_.max_observations);
  return relocaliser_.layout(arena, settings_.max_observations, settings_.max_kept_views);
}

void ImageTracking::init() {
  front_end_.init();
  relocaliser_.init();
  noise_.init(settings_.sigma_px);
  warnings_ = FitWarnings();
}

void ImageTracking::forget_map() {
  front_end_.search().forget_view();
  relocaliser_.init();
}

/// A match along a ray whose depth is open passes nearly everywhere, so not every right frame is beyond chance while fewer features have a
/// depth of their own than a tracked frame needs. A map as young as that is tracked from frame to frame, and not found again after a gap.
ConsensusRule ImageTracking::consensus_rule(const StartProgress& start, std::int64_t since_last_ns) const {
  if (start.pending()) return ConsensusRule::kStart;
  const std::int64_t proposed_ns = update_.proposals().last().frames > 0 ? since_last_ns : 0;
  const double gap_s = seconds(elapsed_ns(tracking_.last_tracked_ns(), frame_.report.t_ns) - proposed_ns);
  if (tracking_.is_relocalising(start) && gap_s > static_cast<double>(tuning::tracking::kMaxYoungGap))
    return ConsensusRule::kBeyondChance;
  int known = 0;
  for (int i = 0; i < map_.features.capacity() && known < settings_.min_inliers; ++i)
    known += map_.features.used(i) && !filter_.state().has_inverse_depth(map_.features[i].slot);
  if (known < settings_.min_inliers) return ConsensusRule::kMostAgree;
  const bool follows = tracking_.is_followed() && gap_s <= static_cast<double>(tuning::tracking::kMaxYoungGap);
  return follows ? ConsensusRule::kFollowed : ConsensusRule::kBeyondChance;
}

void ImageTracking::measure(ConsensusRule rule, const StartProgress& start, Scalar median_depth, bool parallax_lasts) {
  update_.ask_frames(tracking_.is_after_gap(start) ? tuning::relocaliser::kFramesNearby : 0, median_depth);
  front_end_.measure(rule, median_depth, parallax_lasts);
  update_.ask_frames(0, median_depth);
}

void ImageTracking::learn_noise() {
  front_end_.learn_noise();
  warnings_.check(settings_, noise_, filter_.lens());
}

void ImageTracking::keep_view(bool image_usable, const StartProgress& start, Scalar median_depth) {
  front_end_.note_view(tracking_.is_tracked(frame_.report) && !start.recording, median_depth);
  if (image_usable && frame_.report.inliers > 0) front_end_.search().keep_view();
}

}  // namespace pf
