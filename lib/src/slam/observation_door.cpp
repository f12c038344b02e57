#include "base/elapsed.h"
#include "slam/consensus.h"
#include "slam/filter_slam.h"

/// A frame of pixels that the caller has tracked.

namespace pf {

Status FilterSlam::push_observations(const PixelObservation* observations, int count, std::int64_t t_ns) {
  if (takes_images_only()) return Status::kState;
  if (!begin_frame(t_ns)) return Status::kTime;
  if (gave_up_) return end_frame();
  if (!has_pose_) {
    begin_from_knowledge();
    add_target_points();
  }

  for (int i = 0; i < features_.capacity(); ++i) features_[i].asked = false;
  int known = 0;
  {
    StageTimer timer(settings_.hooks, &report_.stage_ns[kGate]);
    for (int i = 0; i < count && known < settings_.max_observations; ++i) {
      const int entry = find_track(observations[i].track);
      if (entry < 0) continue;
      Feature& feature = features_[entry];
      if (feature.is_target && target_withdrawn_) continue;
      if (feature.asked) continue;  // the same id again
      feature.asked = true;
      Observation& o = observation_[known];
      count_frame(&feature.attempts);
      ++report_.attempts;
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
      tracks_[track_count_++] = {entry,
                                 feature.id,
                                 agrees ? TrackStatus::kInlier : TrackStatus::kOutlier,
                                 filter_.state().block[feature.slot].kind,
                                 o.predicted,
                                 S,
                                 o.measured,
                                 nis};
      ++report_.matches;
      if (!agrees) {
        count_frame(&feature.failures);
        count_frame(&feature.rejections);
        continue;
      }
      keep_[known] = 1;
      track_of_[known] = track_count_ - 1;
      entry_[known++] = entry;
    }
  }
  if (known > 0) {
    {
      StageTimer timer(settings_.hooks, &report_.stage_ns[kUpdate]);
      filter_.begin_update(observation_, known);
    }
    take_in(0, known);
  }

  StageTimer timer(settings_.hooks, &report_.stage_ns[kMap]);
  convert_what_is_linear();
  tend_planes();
  drop_what_fails();
  int anchor = -1;
  for (int i = 0; i < count; ++i) {
    if (find_track(observations[i].track) >= 0) continue;
    if (track_count_ >= settings_.max_observations + settings_.max_features) break;
    if (!make_room_at(&anchor)) break;
    const Scalar variance = observations[i].sigma_px * observations[i].sigma_px;
    const int entry = begin_feature(anchor, observations[i].pixel, Mat2::Identity() * variance);
    if (entry < 0) continue;
    features_[entry].track = observations[i].track;
    tracks_[track_count_++] = {
        entry,        features_[entry].id,   TrackStatus::kNew, BlockKind::kInverseDepth, observations[i].pixel,
        Mat2::Zero(), observations[i].pixel, Scalar(0)};
  }
  if (anchor >= 0) filter_.remove(nullptr, 0);  // an anchor that got no child
  return end_frame();
}

int FilterSlam::find_track(std::uint32_t track) const {
  for (int i = 0; i < features_.capacity(); ++i)
    if (features_.used(i) && features_[i].track == track) return i;
  return -1;
}

}  // namespace pf
