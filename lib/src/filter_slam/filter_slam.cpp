#include "filter_slam/filter_slam.h"

#include <algorithm>

#include "base/elapsed.h"
#include "base/limits.h"
#include "filter_slam/pose/usable_pose.h"
#include "frame/feature_upkeep.h"
#include "frame/frame_entry.h"
#include "frame/tuning.h"

namespace pf {

bool FilterSlam::layout(Arena& arena) {
  const Settings& settings = settings_;
  filter_.layout(arena,
                 {settings.max_state_dim, settings.max_features, settings.max_observations, settings.max_planes});
  frame_.layout(arena, settings.max_features + settings.max_observations);
  update_.layout(arena, settings.max_observations);
  upkeep_.layout(arena);
  images_.layout(arena, upkeep_.memory());
  observations_.layout(arena, settings.max_features, settings.max_observations);
  unit_.layout(arena);
  return start_.layout(arena, settings.camera.width, settings.camera.height);
}

void FilterSlam::init() {
  frame_.init();
  tracking_.init();
  data_ = Data();
  motion_.init();
  unit_.init();
  followed_.init();
  images_.init();
  start_.init();
  upkeep_.init();
}

Status FilterSlam::push_frame(const ImageView& image, std::int64_t t_ns) {
  const FrameEntry entry = enter_frame(settings_, image, t_ns, &data_.frozen, &frame_, &tracking_);
  if (entry == FrameEntry::kLate || entry == FrameEntry::kRepeated) return entry_status(entry, tracking_);
  begin_frame(t_ns);
  if (tracking_.started_over()) return end_frame();
  bool usable = entry == FrameEntry::kNew;
  if (usable) {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPyramid]);
    usable = images_.front_end().begin_frame(image);
  }
  if (!usable) return unusable_status(end_frame());
  data_.image_usable = true;
  tracking_.note_usable_image(data_.since_last_ns);
  // W is the plan's as long as there are walls: a new map would begin somewhere else.
  if (tracking_.needs_new_map(settings_.restart_ns) && !map_.planes.has_known() && !upkeep_.is_in_loaded_map())
    begin_new_map("it was not found again within motion.restart_s");
  const StartProgress& progress = start_.recorder().progress();
  const bool first = !tracking_.has_pose();
  images_.relocaliser().begin_frame(data_.since_last_ns);
  if (first) {
    if (!start_.start_in_image()) return end_frame();
  } else {
    MeasureMode mode = {progress.pending(), false, data_.median_depth,
                        start_.recorder().learns_lens_from_first_depths(), UpdateMode()};
    const bool is_lost = tracking_.is_relocalising(progress);
    unit_.measure(data_.follows, [&](bool, const UpdateMode& update) {
      mode.update = update;
      return images_.recover_or_measure(mode, is_lost);
    });
  }
  // Behind the points: after their update a patch has a smaller search area, and where they do not support the pose it does.
  PatchKeeper* const patches = upkeep_.patches();
  if (patches != nullptr && !first)
    patches->measure(images_.front_end().search().tracker().pyramid(), progress.checking);
  const bool supported = tracking_.is_tracked(frame_.report) || progress.pending();
  if (!first && tracking_.is_tracked(frame_.report)) images_.front_end().learn_templates();
  {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kMap]);
    maintain(supported, first);
  }
  upkeep_.maintain_patches(images_.front_end().search().tracker().pyramid(), supported, progress, first);
  return end_frame();
}

/// Maintains the map with an image that has been measured.
void FilterSlam::maintain(bool supported, bool is_first) {
  StartRecorder& recorder = start_.recorder();
  const StartProgress& progress = recorder.progress();
  if (supported) count_searches(frame_, tracking_.belief().share(), &map_.features);
  // While the map starts, residuals are those of a coarse map.
  if (supported && tracking_.state() == SlamState::kTracking && !progress.recording) images_.learn_noise();
  upkeep_.maintain(supported, progress);
  followed_.note(&frame_.correction);
  if (recorder.record_frame(true)) images_.relocaliser().init();  // its views have poses of the wrong map
  const Scalar scale = supported && !is_first ? start_.look_for_walls() : Scalar(0);
  if (scale > Scalar(0)) {  // places and lengths of before no longer hold
    upkeep_.planes().meet_walls();
    data_.median_depth *= scale;
    images_.relocaliser().init();
    upkeep_.forget_places();
  }
  const bool begins_anew = look_for_scale() && map_.features.count() == 0;
  followed_.follow_newest();
  upkeep_.follow_places(recorder.is_recording(), data_.median_depth);
  // A frame that does not support its pose adds features only to a map that has none to lose.
  const bool empty = is_first || progress.pending() || (map_.features.count() == 0 && !upkeep_.is_in_loaded_map());
  if (tracking_.is_tracked(frame_.report) || (empty && frame_.report.attempts == 0) || begins_anew)
    images_.front_end().corners().add();
  recorder.begin_record();
}

Status FilterSlam::push_observations(const PixelObservation* observations, int count, std::int64_t t_ns) {
  if (start_.takes_images_only()) return Status::kState;
  if (!is_next_frame(frame_, t_ns)) return Status::kTime;
  begin_frame(t_ns);
  if (tracking_.started_over()) return end_frame();
  if (!tracking_.has_pose()) start_.start_with_observations();
  unit_.measure(data_.follows, [&](bool again, const UpdateMode& mode) {
    return observations_.measure(observations, count, again, mode);
  });
  if (frame_.report.inliers > 0) tracking_.belief().trust();
  observations_.count(tracking_.belief().share());
  {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kMap]);
    StartRecorder& recorder = start_.recorder();
    upkeep_.maintain(true, recorder.progress());
    followed_.note(&frame_.correction);
    recorder.record_frame(false);
    look_for_scale();
    followed_.follow_newest();
    observations_.add_features(observations, count);
    recorder.begin_record();
  }
  unit_.let_samples_begin();
  return end_frame();
}

Status FilterSlam::mark_pose() {
  if (!tracking_.has_pose()) return Status::kState;
  // A frame that does not support its pose changes nothing in the map.
  return upkeep_.mark().set(frame_.report.t_ns, tracking_.state() == SlamState::kTracking, data_.filter_ns);
}

Status FilterSlam::add_anchor(const AnchorRequest& asked, std::uint32_t* id) {
  if (tracking_.state() != SlamState::kTracking) return Status::kState;
  return upkeep_.anchors().add(asked, tracking_.map_id(), frame_.report.t_ns, data_.filter_ns, id);
}

Status FilterSlam::add_wall(const PlanePrior& prior, std::uint32_t* id) {
  if (!kHasWalls || !settings_.planes || !start_.has_place()) return Status::kState;
  const int reserved = tracking_.has_pose() ? 0 : start_.target_rows();
  const Status status =
      upkeep_.planes().add_wall(prior, reserved, tracking_.state() == SlamState::kTracking, data_.filter_ns, id);
  if (status == Status::kOk && !map_.planes.has_apart()) start_.recorder().init();
  return status;
}

void FilterSlam::predict_pose(std::int64_t t_ns, Body* body, Mat6* covariance) const {
  // Of a frame that repeats the one before, the pose is that one's.
  const std::int64_t now_ns = t_ns > frame_.report.t_ns ? unit_.motion_begin_ns(data_.filter_ns) : t_ns;
  motion_.predict_pose(now_ns, t_ns, body, covariance);
}

/// Begins the report and predicts the body to the new time.
void FilterSlam::begin_frame(std::int64_t t_ns) {
  const std::int64_t before_ns = frame_.report.frames > 0 ? data_.filter_ns : t_ns;
  data_.filter_ns = t_ns;
  data_.since_last_ns = frame_.report.frames > 0 ? std::min(elapsed_ns(before_ns, t_ns), BodyMotion::kMaxGapNs) : 0;
  data_.image_usable = false;
  const bool nothing_measured = frame_.report.inliers == 0;
  data_.follows = tracking_.has_pose() && !tracking_.coasting_or_lost() && !start_.recorder().progress().pending();
  frame_.begin(t_ns);
  followed_.note(&frame_.correction);
  if (data_.map_discredited) begin_new_map(unit_.why_discredited());
  if (images_.is_map_fixed() && tracking_.has_pose() && !map_.planes.has_known())
    begin_new_map("part of the image stands still while the rest moves, and is masked from now on");
  tracking_.begin_frame(data_.since_last_ns);
  if (!tracking_.has_pose()) {
    motion_.init();  // control input is for one frame only
    return;
  }
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[settings_.inertial ? kImu : kPredict]);
  unit_.predict(before_ns, data_.follows, nothing_measured, data_.median_depth);
  if (!filter_.body_is_sound()) start_over();
}

/// True where this frame is the first one whose samples give the scale.
bool FilterSlam::look_for_scale() {
  if (!settings_.inertial || upkeep_.is_in_loaded_map()) return false;  // lengths are those of the map
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kImu]);
  const Scalar correlation = data_.image_usable ? images_.noise().correlation_frames() : Scalar(1);
  const Scalar before = frame_.correction.T.s;
  const ScaleChange change = unit_.look_for_scale(data_.median_depth, correlation);
  if (change == ScaleChange::kRescaled) {
    const Scalar scale = frame_.correction.T.s / before;
    upkeep_.planes().scale(scale);
    data_.median_depth *= scale;
  }
  if (change == ScaleChange::kNewMap || change == ScaleChange::kRescaled) {
    images_.relocaliser().init();
    upkeep_.forget_places();
  }
  return change != ScaleChange::kNone;
}

/// Returns the status of the frame.
Status FilterSlam::end_frame() {
  if (unit_.discredits_map(data_.follows, data_.since_last_ns)) data_.map_discredited = true;
  if (tracking_.has_pose() && !upkeep_.repair_estimate()) start_over();
  const StartProgress& progress = start_.recorder().progress();
  if (tracking_.is_tracked(frame_.report) && !progress.pending()) {
    Scalar patch_depth[kMaxPatches];
    const int patches = upkeep_.patches() != nullptr ? upkeep_.patches()->inlier_depths(patch_depth) : 0;
    if (!is_pose_usable(filter_, map_, frame_, patch_depth, patches, &data_.median_depth))
      tracking_.set_unusable();
    else if (data_.image_usable)
      images_.relocaliser().remember_view(data_.median_depth);
  }
  images_.keep_view(data_.image_usable, progress, data_.median_depth);
  upkeep_.anchors().follow(tracking_.map_id(), data_.filter_ns);
  followed_.note(&frame_.correction);
  return tracking_.conclude(progress, settings_.max_coast_ns, settings_.hooks, &frame_.report);
}

/// The estimate is not finite or P is no covariance: clears everything that came from it.
void FilterSlam::start_over() {
  const std::uint32_t map_id = tracking_.map_id();
  clear_estimate();
  tracking_.start_over();
  settings_.hooks.say("the estimate of map ", map_id, " is not finite, or its covariance is invalid: map ",
                      tracking_.map_id(), " starts without it");
}

/// The map was not found again for too long, although the images were usable, or its scale is discredited: a new one begins with this
/// frame.
void FilterSlam::begin_new_map(const char* why) {
  const std::uint32_t map_id = tracking_.map_id();
  if (!data_.map_discredited && tracking_.has_pose()) start_.mounting().keep();
  clear_estimate();
  tracking_.begin_map();
  data_.map_discredited = false;
  settings_.hooks.say("map ", map_id, " is discarded, map ", tracking_.map_id(), " begins: ", why);
}

void FilterSlam::clear_estimate() {
  frame_.correction = MapCorrection();
  start_.start_over();
  map_.features.clear();
  motion_.init();
  unit_.begin_map();
  images_.forget_map();
  upkeep_.forget_places();
  frame_.forget_all();
}

}  // namespace pf
