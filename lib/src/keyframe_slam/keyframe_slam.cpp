#include "keyframe_slam/keyframe_slam.h"

#include <algorithm>
#include <cmath>

#include "base/elapsed.h"
#include "frame/frame_entry.h"
#include "frame/tuning.h"
#include "keyframe_slam/map/keyframe_upkeep.h"
#include "keyframe_slam/start/tuning.h"
#include "keyframe_slam/tracking/tuning.h"
#include "vision/sharpness.h"

namespace pf {
namespace {

/// Whether rotation and position are known well enough against the map (lib/docs/theory/states.md).
bool is_usable(const Mat6& P, Scalar median_depth) {
  using namespace tuning::usable_pose;
  const Scalar position = kMaxPositionSigma * median_depth;
  return P(0, 0) + P(1, 1) + P(2, 2) < kMaxRotationSigma * kMaxRotationSigma &&
         P(3, 3) + P(4, 4) + P(5, 5) < position * position;
}

}  // namespace

bool KeyframeSlam::layout(Arena& arena) {
  frame_.layout(arena, 2 * settings_.max_features);
  map_.layout(arena);
  search_.layout(arena);
  pose_.layout(arena);
  mapping_.layout(arena);
  planes_.layout(arena);
  placement_.layout(arena);
  unit_.layout(arena);
  relocaliser_.layout(arena);
  record_.layout(arena);
  return start_.layout(arena);
}

void KeyframeSlam::init() {
  frame_.init();
  noise_.init(settings_.sigma_px);
  tracking_.init();
  map_.init();
  map_.places.init();
  motion_.init();
  search_.init();
  pose_.init();
  mapping_.init();
  placement_.init();
  unit_.init();
  relocaliser_.init();
  record_.init();
  start_.init();
  data_ = Data();
}

Status KeyframeSlam::push_frame(const ImageView* image, std::int64_t t_ns) {
  if (image == nullptr && start_.takes_images_only()) return Status::kState;
  const FrameEntry of_pixels = is_next_frame(frame_, t_ns) ? FrameEntry::kNew : FrameEntry::kLate;
  const FrameEntry entry =
      image == nullptr ? of_pixels : enter_frame(settings_, *image, t_ns, &data_.frozen, &frame_, &tracking_);
  if (entry == FrameEntry::kLate || entry == FrameEntry::kRepeated) return entry_status(entry, tracking_);
  data_.has_image = image != nullptr;
  begin_frame(t_ns);
  if (tracking_.started_over()) return end_frame();
  bool usable = entry == FrameEntry::kNew;
  if (usable) {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPyramid]);
    usable = search_.begin_frame(image);
  }
  if (!usable) return unusable_status(end_frame());
  Scalar sharpness;
  if (image != nullptr && measure_sharpness(search_.images().tracker().pyramid(), &sharpness))
    tracking_.belief().note_sharpness(sharpness);
  track();
  return end_frame();
}

/// Measures a frame, and learns from it.
void KeyframeSlam::track() {
  tracking_.note_usable_image(data_.since_last_ns);
  const bool has_walls = map_.tables().planes.has_known();
  const bool may_leave = !start_.is_in_loaded_map() && !has_walls;
  const bool is_gone = may_leave && tracking_.needs_new_map(settings_.restart_ns);
  const bool is_fixed = data_.is_map_fixed && tracking_.has_pose() && !has_walls;
  if (is_gone || is_fixed) {
    const std::uint32_t map_id = tracking_.map_id();
    if (is_gone) relocaliser_.leave_map(map_id);
    discard_map();
    tracking_.begin_map();
    settings_.hooks.say("map ", map_id, map_.places.has_other() ? " is left, map " : " is discarded, map ",
                        tracking_.map_id(), " begins: ",
                        is_gone ? "it was not found again within motion.restart_s"
                                : "part of the image stands still while the rest moves, and is masked from now on");
  }
  bool again = false;
  do {
    if (again) frame_.begin_again();
    measure();
    again = unit_.take_pose(placement_.map_of_unit(data_.median_depth));
  } while (again);
  data_.is_map_fixed = search_.note_fixed(motion_.view());
  learn();
  if (data_.second.given && data_.second.has_come(frame_.report.t_ns))
    placement_.scale_by_second_pose(&data_.median_depth);
}

/// Begins the report and predicts the body to the new time.
void KeyframeSlam::begin_frame(std::int64_t t_ns) {
  const std::int64_t before_ns = data_.body_ns;
  data_.body_ns = t_ns;
  data_.since_last_ns = frame_.report.frames > 0 ? elapsed_ns(before_ns, t_ns) : 0;
  const bool nothing_measured = frame_.report.inliers == 0;
  frame_.begin(t_ns);
  const bool follows = tracking_.has_pose() && !tracking_.coasting_or_lost() && !record_.progress().pending();
  tracking_.begin_frame(data_.since_last_ns);
  if (!tracking_.has_pose() || data_.since_last_ns == 0) return motion_.forget_control();
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[settings_.inertial ? kImu : kPredict]);
  const bool coasts = tracking_.coasting_or_lost();
  if (!unit_.predict(before_ns, follows, coasts, nothing_measured, data_.median_depth))
    motion_.advance(before_ns, t_ns, coasts, nothing_measured);
}

/// Finds the pose of the frame, by the method that belongs to the state.
void KeyframeSlam::measure() {
  data_.young = num_placed(map_) < tuning::keyframe_tracking::kYoung;
  if (!tracking_.has_pose()) {
    start_.start_in_image();
  } else if (record_.progress().pending()) {
    if (record_.follow()) mapping_.adjust();
  } else if (data_.young && !start_.is_in_loaded_map()) {
    measuring_.measure_young(data_.median_depth);
  } else if (data_.has_image && tracking_.is_relocalising(record_.progress()) &&
             !relocaliser_.is_prediction_narrow(data_.median_depth)) {
    tracking_.belief().spend();
    relocaliser_.recover(data_.median_depth);
    const Mat6* place = relocaliser_.found_covariance();
    if (place != nullptr && tracking_.is_tracked(frame_.report)) mapping_.adjustment().begin_at(*place);
    data_.young = num_placed(map_) < tuning::keyframe_tracking::kYoung;
  } else {
    relocaliser_.clear_proposal();
    measuring_.measure(data_.median_depth);
  }
  if (record_.progress().recording && record_.progress().depth_known && tracking_.is_tracked(frame_.report)) {
    const CameraView before = motion_.view();
    if (!record_.improve()) return;
    placement_.keep_anchors(before, motion_.view());
    mapping_.adjust();
    const CameraView now = motion_.view();
    frame_.correction.add(Similarity::between(before.q_WC, before.c_W, now.q_WC, now.c_W));
  }
}

/// Learns noise and templates from the frame, and updates the map. A frame that does not support its pose changes nothing in the map.
void KeyframeSlam::learn() {
  if (!tracking_.has_pose()) return;
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kMap]);
  const bool tracked = tracking_.is_tracked(frame_.report);
  if (tracked && !record_.progress().pending()) {
    search_.learn_templates(prior_of(motion_));
    if (data_.has_image) measuring_.learn_noise();
    data_.warnings.check(settings_, noise_, map_.camera());
  }
  const bool is_keyframe = mapping_.keep(tracked, data_.young, data_.median_depth, tracking_.belief().share());
  const int newest = map_.keyframes.newest();
  if (record_.progress().pending() && map_.keyframes.count() == 1 && map_.keyframes[newest].t_ns == frame_.report.t_ns)
    placement_.begin_at_walls(&data_.median_depth);
  const bool is_adjusted =
      newest >= 0 && map_.keyframes[newest].t_ns == frame_.report.t_ns && map_.keyframes.count() > 1;
  if (tracked && is_adjusted && !record_.progress().pending()) {
    placement_.follow_unit(&data_.median_depth);
    placement_.tend_walls(&data_.median_depth);
  }
  MovingSolution solution;
  if (unit_.look_for_scale(placement_.map_of_unit(data_.median_depth), &solution))
    placement_.scale_by_unit(solution, &data_.median_depth);
  // A keyframe has work enough.
  if (!tracked || is_keyframe || record_.progress().pending() || !data_.has_image) return;
  relocaliser_.note_view(data_.median_depth);
  const MapJoin join = relocaliser_.take_join();
  if (join.map_id != 0) return placement_.join(join, &data_.median_depth);
  if (settings_.inertial || map_.tables().planes.has_known()) return;
  relocaliser_.keeper().follow_keyframes();
  const LoopClosure loop = mapping_.loops().look(motion_, data_.median_depth);
  if (loop.place != 0) placement_.close_loop(loop, &data_.median_depth);
}

/// Returns the status of the frame.
Status KeyframeSlam::end_frame() {
  const char* const why = unit_.leaves_metres(placement_.map_of_unit(data_.median_depth), data_.since_last_ns);
  if (why != nullptr) placement_.leave_metres(why);
  if (tracking_.has_pose() && !motion_.is_sound()) {
    const std::uint32_t map_id = tracking_.map_id();
    discard_map();
    tracking_.start_over();
    settings_.hooks.say("the estimate of map ", map_id, " is not finite, or its covariance is invalid: map ",
                        tracking_.map_id(), " starts without it");
  }
  if (tracking_.is_tracked(frame_.report) && !record_.progress().pending()) {
    const Scalar depth = map_.median_depth(motion_.body().q_WC, motion_.body().p_W);
    const bool has_depth = depth > Scalar(0);
    if (has_depth) data_.median_depth = depth;
    if (!has_depth || !is_usable(motion_.pose_covariance(), depth))
      tracking_.set_unusable();
    else if (frame_.report.attempts > 0 && data_.has_image)
      relocaliser_.remember_view();
  }
  if (tracking_.has_pose() && (tracking_.is_tracked(frame_.report) || record_.progress().pending()))
    search_.keep_view(motion_.view());
  search_.follow(frame_.correction.T);
  anchors_.follow(tracking_.map_id(), data_.median_depth);
  return tracking_.conclude(record_.progress(), settings_.max_coast_ns, settings_.hooks, &frame_.report);
}

/// Clears the map, and all that refers to poses in it.
void KeyframeSlam::discard_map() {
  frame_.correction = MapCorrection();
  start_.start_over();
  motion_.init();
  relocaliser_.init();
  search_.forget_view();
  mapping_.init();
  placement_.init();
  unit_.begin_map();
}

}  // namespace pf
