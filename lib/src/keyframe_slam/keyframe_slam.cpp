#include "keyframe_slam/keyframe_slam.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "frame/feature_upkeep.h"
#include "frame/frame_entry.h"
#include "frame/tuning.h"
#include "keyframe_slam/adjustment/scale.h"
#include "keyframe_slam/map/depth.h"
#include "keyframe_slam/map/rows.h"
#include "keyframe_slam/start/tuning.h"
#include "keyframe_slam/tracking/corners.h"
#include "keyframe_slam/tracking/frame_time.h"
#include "keyframe_slam/tracking/tuning.h"
#include "keyframe_slam/tuning.h"

namespace pf {

using namespace tuning::keyframe_slam;

bool KeyframeSlam::layout(Arena& arena) {
  frame_.layout(arena, 2 * settings_.max_features);
  map_.layout(arena);
  search_.layout(arena);
  pose_.layout(arena);
  adjustment_.layout(arena);
  planes_.layout(arena);
  relocaliser_.layout(arena);
  record_.layout(arena);
  return start_.layout(arena);
}

void KeyframeSlam::init() {
  frame_.init();
  noise_.init(settings_.sigma_px);
  tracking_.init();
  map_.init();
  motion_.init();
  search_.init();
  pose_.init();
  adjustment_.init();
  planes_.init();
  relocaliser_.init();
  record_.init();
  start_.init();
  data_ = Data();
}

Status KeyframeSlam::push_frame(const ImageView& image, std::int64_t t_ns) {
  const FrameEntry entry = enter_frame(settings_, image, t_ns, &data_.frozen, &frame_, &tracking_);
  if (entry == FrameEntry::kLate || entry == FrameEntry::kRepeated) return entry_status(entry, tracking_);
  begin_frame(t_ns);
  if (tracking_.started_over()) return end_frame();
  bool usable = entry == FrameEntry::kNew;
  if (usable) {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPyramid]);
    usable = search_.begin_frame(image);
  }
  if (!usable) return unusable_status(end_frame());
  tracking_.note_usable_image(data_.since_last_ns);
  if (tracking_.needs_new_map(settings_.restart_ns))
    begin_new_map("not found again for too long: the old map is discarded, a new map begins");
  measure();
  maintain_map();
  if (data_.second.given && data_.second.has_come(t_ns)) scale_by_second_pose();
  return end_frame();
}

Status KeyframeSlam::mark_pose() {
  if (!tracking_.has_pose()) return Status::kState;
  const Body& body = motion_.body();
  data_.mark = {true, frame_.report.t_ns, body.q_WC, body.p_W, motion_.pose_covariance()};
  return Status::kOk;
}

/// Begins the report and predicts the body to the new time.
void KeyframeSlam::begin_frame(std::int64_t t_ns) {
  const std::int64_t before_ns = data_.body_ns;
  data_.body_ns = t_ns;
  data_.since_last_ns = frame_.report.frames > 0 ? elapsed_ns(before_ns, t_ns) : 0;
  const bool nothing_measured = frame_.report.inliers == 0;
  frame_.begin(t_ns);
  tracking_.begin_frame();
  if (!tracking_.has_pose()) return;
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPredict]);
  motion_.advance(before_ns, t_ns, tracking_.coasting_or_lost(), nothing_measured);
}

/// Finds the pose of the frame, in the way that the state asks for.
void KeyframeSlam::measure() {
  data_.young = map_.placed() < tuning::keyframe_tracking::kYoung;
  if (!tracking_.has_pose()) {
    start_.start_in_image();
  } else if (record_.progress().pending()) {
    if (record_.follow()) adjust();
  } else if (data_.young) {
    measuring_.measure_young(data_.median_depth);
  } else if (tracking_.is_relocalising(record_.progress())) {
    relocaliser_.recover(data_.median_depth);
  } else {
    relocaliser_.clear_proposal();
    measuring_.measure(data_.median_depth);
  }
  if (record_.progress().recording && record_.progress().depth_known && tracking_.is_tracked(frame_.report) &&
      record_.improve())
    adjust();
}

/// A frame that does not support its pose changes nothing in the map.
void KeyframeSlam::maintain_map() {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kMap]);
  const bool pending = record_.progress().pending();
  const bool tracked = tracking_.is_tracked(frame_.report);
  if (!tracking_.has_pose()) return;
  if (tracked && !pending) {
    search_.learn_templates(prior_of(motion_));
    learn_noise();
    // A young map's poses are too coarse for depths of their own: a keyframe's are adjusted with it.
    if (!data_.young) triangulate(true);
  }
  count_searches(frame_, &map_.tables().features, tracked || pending);
  if (tracked || pending) map_.drop_failing();
  if (tracked && !pending && wants_keyframe()) add_keyframe();
  // The first frame, one in which a record began anew, and every other keyframe.
  const int newest = map_.keyframes.newest();
  if (newest < 0 || map_.keyframes[newest].t_ns != frame_.report.t_ns) return;
  Keyframe& keyframe = map_.keyframes[newest];
  if (keyframe.number > 1) {
    keyframe.v_W = motion_.body().v_W;
    keyframe.w_C = motion_.body().w_C;
    keyframe.row_depth = pending ? settings_.start_depth : data_.median_depth;
  }
  add_corners(settings_, search_.images(), newest, motion_.body(), keyframe.row_depth, &map_, &frame_);
  record_.begin_at_keyframe();
}

/// Gives points a depth whose rays from host and frame differ by enough; strict: drops those that no depth explains.
void KeyframeSlam::triangulate(bool strict) {
  const CameraView now = {motion_.body().q_WC, motion_.body().p_W};
  const Scalar cos_parallax = std::cos(kMinParallax);
  for (int t = 0; t < frame_.match_count(); ++t) {
    const Match& match = frame_.match(t);
    if (match.feature < 0 || match.status != MatchStatus::kInlier || map_.point(match.feature).has_depth) continue;
    DepthFit fit;
    const bool fits = fit_depth(map_.camera(), map_, match.feature, now, map_.point(match.feature).pixel, &fit);
    if (fit.cos_parallax > cos_parallax) continue;
    if (!fits || (strict && fit.worst_px > pose_.bound_px())) {
      if (strict) map_.drop(match.feature);
      continue;
    }
    KeyframePoint& point = map_.point(match.feature);
    if (has_rows(map_.camera())) correct_rows(match, now, &fit);
    point.rho = fit.rho;
    point.variance = noise_.sigma_info() * noise_.sigma_info() / fit.information;
    point.has_depth = true;
  }
}

/// Rows of a point whose depth has become known, and so its depth once more.
void KeyframeSlam::correct_rows(const Match& match, const CameraView& now, DepthFit* fit) {
  map_.correct_rows(match.feature, fit->rho);
  KeyframePoint& point = map_.point(match.feature);
  if (!data_.young) point.pixel = match_at_frame_time(map_, match, prior_of(motion_), 1 / fit->rho);
  DepthFit again;
  if (fit_depth(map_.camera(), map_, match.feature, now, point.pixel, &again)) *fit = again;
}

/// The camera has moved far enough since the last keyframe, in depths of what it sees, or sees too little of what is known.
bool KeyframeSlam::wants_keyframe() const {
  const Keyframe& last = map_.keyframes[map_.keyframes.newest()];
  if (last.t_ns == frame_.report.t_ns) return false;
  const Body& body = motion_.body();
  const Scalar moved = (body.p_W - last.p_W).norm() / data_.median_depth;
  const Scalar turned = body.q_WC.angularDistance(last.q_WC);
  int inliers = 0;
  for (int t = 0; t < frame_.match_count(); ++t) inliers += frame_.match(t).status == MatchStatus::kInlier ? 1 : 0;
  // A record that goes on makes the others itself.
  return moved > kKeyframeShift || turned > kKeyframeTurn ||
         ((!data_.young || map_.keyframes.count() > 1) && !record_.progress().recording &&
          static_cast<Scalar>(inliers) < kFewPoints * static_cast<Scalar>(settings_.features_in_view) &&
          (moved > kMinKeyframeShift || turned > kMinKeyframeTurn));
}

void KeyframeSlam::add_keyframe() {
  record_.note_keyframe();
  map_.add_keyframe(frame_.report.t_ns, motion_.body().q_WC, motion_.body().p_W);
  map_.keyframes[map_.keyframes.newest()].matches_by_motion = !data_.young;
  if (data_.young) triangulate(false);
  adjust();
}

void KeyframeSlam::adjust() {
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kAdjust]);
  // A record is solved by one lens, which changes no more until it ends.
  const Keyframe& newest = map_.keyframes[map_.keyframes.newest()];
  const CameraView before = {newest.q_WC, newest.p_W};
  if (!adjustment_.run(!record_.progress().recording)) return;
  map_.move_views(before);
  motion_.move(newest.q_WC, newest.p_W);
  // During a start the map may begin again; ids of planes found before would then name nothing.
  if (settings_.planes && !record_.progress().recording) planes_.maintain(newest.p_W);
}

Status KeyframeSlam::use_second_pose(std::int64_t t_ns, const Vec3& p_W, Scalar sigma) {
  if (!is_next_frame(frame_, t_ns)) return Status::kTime;
  if (!((p_W - start_.first_place_W()).norm() > sigma)) return Status::kRange;
  return start_.use_second_pose(t_ns, p_W);
}

/// The map keeps its shape: the distance of the frame from the first place becomes the known one. Of a frame before depths were known, its
/// place is the solved record's.
void KeyframeSlam::scale_by_second_pose() {
  const SecondPose second = data_.second;
  if (record_.progress().pending()) return;
  const Vec3 first_W = start_.first_place_W();
  const bool is_now = second.is_frame(frame_.report.t_ns) && tracking_.is_tracked(frame_.report);
  const Vec3 at_W = is_now ? motion_.body().p_W : second.estimate_W;
  const Scalar moved = (at_W - first_W).norm();
  const Scalar scale = (second.p_W - first_W).norm() / moved;
  data_.second = SecondPose();
  record_.init();
  if (!(is_now || second.estimated) || !(moved > tuning::second_pose::kMinSecondShift * data_.median_depth) ||
      !std::isfinite(scale)) {
    settings_.hooks.say("the second pose gives no scale: its frame was not tracked, or the camera had not moved");
    return;
  }
  scale_window(scale, first_W, &map_, &planes_, &motion_);
  adjustment_.scale(scale);
  relocaliser_.init();
  data_.median_depth *= scale;
  if (data_.mark.is_set) data_.mark = Mark();
  settings_.hooks.say("the scale is that of the second pose");
}

void KeyframeSlam::learn_noise() {
  measuring_.learn_noise();
  data_.warnings.check(settings_, noise_, map_.camera());
}

/// Whether rotation and position are known well enough against the map (lib/docs/states.md).
bool KeyframeSlam::is_pose_usable() {
  using namespace tuning::usable_pose;
  const Scalar depth = map_.median_depth(motion_.body().q_WC, motion_.body().p_W);
  if (!(depth > Scalar(0))) return false;
  data_.median_depth = depth;
  const Mat6 P = motion_.pose_covariance();
  const Scalar position = kMaxPositionSigma * depth;
  return P(0, 0) + P(1, 1) + P(2, 2) < kMaxRotationSigma * kMaxRotationSigma &&
         P(3, 3) + P(4, 4) + P(5, 5) < position * position;
}

/// Returns the status of the frame.
Status KeyframeSlam::end_frame() {
  if (tracking_.has_pose() && !motion_.is_sound()) {
    start_.start_over();
    motion_.init();
    relocaliser_.init();
    search_.forget_view();
    tracking_.start_over();
    settings_.hooks.say("the estimate is no longer finite: starting again without it");
  }
  if (tracking_.is_tracked(frame_.report) && !record_.progress().pending()) {
    if (!is_pose_usable())
      tracking_.set_unusable();
    else if (frame_.report.attempts > 0)
      relocaliser_.remember_view();
  }
  if (tracking_.has_pose() && (tracking_.is_tracked(frame_.report) || record_.progress().pending()))
    search_.keep_view({motion_.body().q_WC, motion_.body().p_W});
  return tracking_.conclude(frame_.report, record_.progress(), settings_.max_coast_ns, settings_.hooks);
}

/// The map was not found again for too long, although the images were usable: a new one begins with this frame.
void KeyframeSlam::begin_new_map(const char* why) {
  start_.start_over();
  motion_.init();
  relocaliser_.init();
  search_.forget_view();
  adjustment_.init();
  data_.mark = Mark();
  tracking_.begin_map();
  settings_.hooks.say(why);
}

}  // namespace pf
