#include "base/elapsed.h"
#include "slam/consensus.h"
#include "slam/filter_slam.h"

/// A frame of pixels that the caller has tracked.

namespace pf {

Status FilterSlam::push_observations(const PixelObservation* observations, int count, std::int64_t t_ns) {
  if (takes_images_only()) return Status::kState;
  if (!begin_frame(t_ns)) return Status::kTime;
  if (tracking_.gave_up()) return end_frame();
  if (!tracking_.has_pose()) {
    begin_from_knowledge();
    add_target_points();
  }

  for (int i = 0; i < map_.features.capacity(); ++i) map_.features[i].asked = false;
  int known = 0;
  {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kGate]);
    for (int i = 0; i < count && known < settings_.max_observations; ++i) {
      const int entry = find_track(observations[i].track);
      if (entry < 0) continue;
      Feature& feature = map_.features[entry];
      if (feature.is_target && map_.target_withdrawn) continue;
      if (feature.asked) continue;  // the same id again
      feature.asked = true;
      Observation& o = observation_[known];
      count_frame(&feature.attempts);
      ++frame_.report.attempts;
      if (!filter_.predict_pixel(settings_.camera, feature.slot, &o)) {
        count_frame(&feature.failures);
        continue;
      }
      const Mat2 spread = expected_innovation(&o);
      o.measured = observations[i].pixel;
      o.noise = Mat2::Identity() * (observations[i].sigma_px * observations[i].sigma_px) + o.second_order;
      const Mat2 S = spread + o.noise;
      const Scalar nis = squared_distance(o.measured - o.predicted, S);
      const bool agrees = nis < settings_.gate;
      track_of_[known] = frame_.add({entry, feature.id, agrees ? MatchStatus::kInlier : MatchStatus::kOutlier,
                                     filter_.state().block[feature.slot].kind, o.predicted, S, o.measured, nis});
      ++frame_.report.matches;
      if (!agrees) {
        count_frame(&feature.failures);
        count_frame(&feature.rejections);
        continue;
      }
      keep_[known] = 1;
      entry_[known++] = entry;
    }
  }
  if (known > 0) {
    {
      StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kUpdate]);
      filter_.begin_update(observation_, known);
    }
    take_in(0, known);
  }

  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kMap]);
  convert_what_is_linear();
  tend_planes();
  drop_what_fails();
  int anchor = -1;
  for (int i = 0; i < count; ++i) {
    if (find_track(observations[i].track) >= 0) continue;
    if (frame_.full()) break;
    if (!make_room_at(&anchor)) break;
    const Scalar variance = observations[i].sigma_px * observations[i].sigma_px;
    const int entry = begin_feature(anchor, observations[i].pixel, Mat2::Identity() * variance);
    if (entry < 0) continue;
    map_.features[entry].track = observations[i].track;
    frame_.add({entry, map_.features[entry].id, MatchStatus::kNew, BlockKind::kInverseDepth, observations[i].pixel,
                Mat2::Zero(), observations[i].pixel, Scalar(0)});
  }
  if (anchor >= 0) filter_.remove(nullptr, 0);  // an anchor that got no child
  return end_frame();
}

int FilterSlam::find_track(std::uint32_t track) const {
  for (int i = 0; i < map_.features.capacity(); ++i)
    if (map_.features.used(i) && map_.features[i].track == track) return i;
  return -1;
}

}  // namespace pf
