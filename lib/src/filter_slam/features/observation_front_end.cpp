#include "filter_slam/features/observation_front_end.h"

#include <algorithm>

#include "base/elapsed.h"
#include "base/table_entries.h"
#include "filter_slam/pose/consensus.h"
#include "frame/feature_upkeep.h"
#include "frame/tuning.h"

namespace pf {

namespace {

constexpr unsigned char kSeen = 1, kCounted = 2;

}  // namespace

bool ObservationFrontEnd::layout(Arena& arena, int max_features, int max_observations) {
  seen_ = arena.take<unsigned char>(static_cast<std::size_t>(max_features));
  inbox_ = arena.take<PixelObservation>(static_cast<std::size_t>(max_features + max_observations));
  return arena.ok();
}

UpdateOutcome ObservationFrontEnd::measure(const PixelObservation* observations, int count, bool again,
                                           const UpdateMode& mode) {
  const int known = gate(observations, count, again);
  // Where the prediction may be wrong, the few that pass a gate which rejects most pass it by chance.
  const bool is_in_doubt = mode.max_pose_nis > Scalar(0);
  if (known == 0 || (is_in_doubt && tuning::image_front_end::kFewPassing * known < frame_.report.matches))
    return UpdateOutcome();
  update_.begin(0, known);
  const UpdateOutcome outcome = update_.apply(0, known, mode);
  frame_.report.nis += outcome.nis;
  return outcome;
}

/// Lists observations of the map's features as matches, and those inside of their gate as candidates. Returns how many candidates.
int ObservationFrontEnd::gate(const PixelObservation* observations, int count, bool again) {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kGate]);
  // Measured again, a full frame may take other features than the first time; those are counted now.
  for (int i = 0; i < map_.features.capacity(); ++i)
    seen_[i] = again ? static_cast<unsigned char>(seen_[i] & kCounted) : 0;
  int known = 0;
  for (int i = 0; i < count && known < settings_.max_observations; ++i) {
    const int entry = find(observations[i].external_id);
    if (entry < 0) continue;
    Feature& feature = map_.features[entry];
    if (feature.is_target && map_.target_withdrawn) continue;
    if ((seen_[entry] & kSeen) != 0) continue;  // the same id again
    const bool counts = seen_[entry] == 0;
    const auto count_up = [counts](auto* counter) {
      if (counts) count_frame(counter);
    };
    seen_[entry] = kSeen | kCounted;
    PixelMeasurement& o = update_.observation(known);
    count_up(&feature.attempts);
    ++frame_.report.attempts;
    if (!filter_.predict_pixel(filter_.lens(), feature.slot, &o)) continue;
    const Mat2 spread = update_.expected_innovation(&o);
    o.measured = observations[i].pixel;
    o.set_noise(Mat2::Identity() * (observations[i].sigma_px * observations[i].sigma_px) + o.second_order);
    const Mat2 S = spread + o.R_gate;
    if (!is_covariance(S)) continue;
    const Scalar nis = squared_distance(o.measured - o.predicted, S);
    const bool is_inlier = nis < settings_.gate;
    const int match =
        frame_.add({entry, feature.id, is_inlier ? MatchStatus::kInlier : MatchStatus::kOutlier,
                    filter_.state().block[feature.slot].kind, false, false, o.predicted, S, o.measured, nis});
    ++frame_.report.matches;
    if (!is_inlier) {
      count_up(&feature.rejections);
      continue;
    }
    update_.keep()[known] = 1;
    update_.candidate(known++) = {entry, match};
  }
  return known;
}

void ObservationFrontEnd::count(const FindShare& mean) {
  int observed = 0;
  for (int i = 0; i < map_.features.capacity(); ++i) observed += (seen_[i] & kSeen) != 0 ? 1 : 0;
  const Scalar share = mean.in_frame(observed, std::min(frame_.report.inliers, observed));
  for (const int i : used_entries(map_.features))
    if ((seen_[i] & kSeen) != 0)
      note_search(map_.features[i].last_seen_ns == frame_.report.t_ns, share, &map_.features[i]);
}

void ObservationFrontEnd::add_features(const PixelObservation* observations, int count) {
  int anchor = -1;
  for (int i = 0; i < count; ++i) {
    const PixelObservation& o = observations[i];
    if (find(o.external_id) >= 0) continue;
    if (frame_.full() || !features_.make_room_at(&anchor)) break;
    const int entry = features_.add(anchor, o.pixel, Mat2::Identity() * (o.sigma_px * o.sigma_px));
    if (entry < 0) continue;
    map_.features[entry].external_id = o.external_id;
    frame_.add({entry, map_.features[entry].id, MatchStatus::kNew, BlockKind::kInverseDepth, false, false, o.pixel,
                Mat2::Zero(), o.pixel, Scalar(0)});
  }
  if (anchor >= 0) filter_.remove(nullptr, 0);  // removes an anchor without children
}

int ObservationFrontEnd::find(std::uint32_t external_id) const {
  for (const int i : used_entries(map_.features))
    if (map_.features[i].external_id == external_id) return i;
  return -1;
}

}  // namespace pf
