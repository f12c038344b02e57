#include "keyframe_slam/keyframe_mapping.h"

#include "base/elapsed.h"
#include "frame/feature_upkeep.h"
#include "keyframe_slam/map/keyframe_upkeep.h"
#include "keyframe_slam/tracking/corners.h"
#include "keyframe_slam/triangulation.h"
#include "keyframe_slam/tuning.h"

namespace pf {

using namespace tuning::keyframe_slam;

bool KeyframeMapping::keep(bool tracked, bool young, Scalar median_depth, const FindShare& share) {
  const bool pending = record_.progress().pending();
  // Poses of a map with few depths are too coarse to triangulate from; the adjustment of a keyframe gives depths.
  if (tracked && !pending && !young) triangulate_inliers(young);
  count_searches(frame_, share, &map_.tables().features, tracked || pending);
  if (tracked || pending) drop_failing(&map_);
  const bool is_keyframe = tracked && !pending && wants_keyframe(young, median_depth);
  if (is_keyframe) add_frame(young, median_depth);
  // The first frame, one in which a record began anew, and every other keyframe.
  const int newest = map_.keyframes.newest();
  if (newest >= 0 && map_.keyframes[newest].t_ns == frame_.report.t_ns) add_points(pending, median_depth);
  return is_keyframe;
}

void KeyframeMapping::triangulate_inliers(bool young) {
  triangulate(frame_, motion_, {noise_.sigma_info(), pose_.bound_px(), !young}, &map_);
}

/// The camera has moved far enough since the last keyframe, in depths of what it sees, or sees too little of what is known.
bool KeyframeMapping::wants_keyframe(bool young, Scalar median_depth) const {
  const Keyframe& last = map_.keyframes[map_.keyframes.newest()];
  if (last.t_ns == frame_.report.t_ns) return false;
  const Body& body = motion_.body();
  const Scalar moved = (body.p_W - last.p_W).norm() / median_depth;
  const Scalar turned = body.q_WC.angularDistance(last.q_WC);
  int inliers = 0;
  for (int t = 0; t < frame_.match_count(); ++t) inliers += frame_.match(t).status == MatchStatus::kInlier ? 1 : 0;
  // A record that still gets better makes the others itself.
  return moved > kKeyframeShift || turned > kKeyframeTurn ||
         ((!young || map_.keyframes.count() > 1) && !record_.is_improving() &&
          static_cast<Scalar>(inliers) < kFewPoints * static_cast<Scalar>(settings_.features_in_view) &&
          (moved > kMinKeyframeShift || turned > kMinKeyframeTurn));
}

/// As a keyframe. As far as the adjustment moves it, so have the poses that were given out just before. In a map that began elsewhere,
/// where the pose is against its places, one that is near comes back.
void KeyframeMapping::add_frame(bool young, Scalar median_depth) {
  record_.note_keyframe();
  const int leaving = leaving_keyframe(map_, settings_.window_keyframes);
  if (leaving >= 0) keeper_.keep(leaving);
  const CameraView before = motion_.view();
  const int keyframe = add_keyframe(frame_, motion_.view(), settings_.window_keyframes, &map_);
  map_.keyframes[keyframe].matches_by_motion = !young;
  map_.keyframes[keyframe].v_W = motion_.body().v_W;
  map_.keyframes[keyframe].w_C = motion_.body().w_C;
  if (young) triangulate_inliers(young);
  adjust();
  loops_.add_keyframe(adjustment_);
  const CameraView now = motion_.view();
  frame_.correction.add(Similarity::between(before.q_WC, before.c_W, now.q_WC, now.c_W));
  if (map_.keyframes.began_elsewhere()) keeper_.bring_near(motion_.view(), median_depth, 1);
}

/// New points at corners of the newest keyframe's image, which is this frame's.
void KeyframeMapping::add_points(bool pending, Scalar median_depth) {
  const int newest = map_.keyframes.newest();
  Keyframe& keyframe = map_.keyframes[newest];
  if (!map_.keyframes.is_first(newest)) {
    keyframe.v_W = motion_.body().v_W;
    keyframe.w_C = motion_.body().w_C;
    keyframe.row_depth = pending ? settings_.start_depth : median_depth;
  }
  if (given_.are_given())
    add_given(given_, newest, motion_.body(), keyframe.row_depth, &map_, &frame_);
  else
    add_corners(settings_, search_.images(), newest, motion_.body(), keyframe.row_depth, &map_, &frame_);
  record_.begin_at_keyframe();
}

void KeyframeMapping::adjust() {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kAdjust]);
  // A record is solved by one lens, which changes no more until it ends.
  const Keyframe& newest = map_.keyframes[map_.keyframes.newest()];
  const CameraView before = newest.view();
  if (!adjustment_.run(!record_.progress().recording)) return;
  move_views(before, &map_);
  motion_.move(newest.q_WC, newest.p_W);
  // From the first depths on. While a start's record goes on the map may begin again, which removes the planes.
  if (settings_.planes && !record_.progress().pending()) planes_.maintain(newest.p_W);
}

}  // namespace pf
