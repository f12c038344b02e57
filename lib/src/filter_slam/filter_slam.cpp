#include "filter_slam/filter_slam.h"

#include <algorithm>
#include <new>

#include "base/elapsed.h"
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
  features_.layout(arena, settings.max_features);
  planes_.layout(arena, settings.max_features);
  images_.layout(arena, settings.max_observations);
  relocaliser_.layout(arena, settings.max_observations, settings.max_kept_views);
  observations_.layout(arena, settings.max_features, settings.max_observations);
  watch_.layout(arena);
  rest_.layout(arena);
  layout_unit(arena);
  start_.layout(arena, settings.camera.width, settings.camera.height);
  return layout_patches(arena);
}

/// Patches take nothing where there are none.
bool FilterSlam::layout_patches(Arena& arena) {
  if (settings_.max_patches == 0) return arena.ok();
  PatchKeeper* place = arena.take<PatchKeeper>(1);
  if (place == nullptr) return PatchKeeper(settings_, filter_, map_, frame_, features_, tracking_).layout(arena);
  patches_ = new (place) PatchKeeper(settings_, filter_, map_, frame_, features_, tracking_);
  return patches_->layout(arena);
}

void FilterSlam::init() {
  frame_.init();
  tracking_.init();
  frozen_.init();
  data_ = Data();
  motion_.init();
  watch_.init();
  rest_.init();
  init_unit();
  planes_.init();
  images_.init();
  relocaliser_.init();
  noise_.init(settings_.sigma_px);
  start_.init();
  metric_.init();
  if (patches_ != nullptr) patches_->init();
}

Status FilterSlam::push_frame(const ImageView& image, std::int64_t t_ns) {
  const FrameEntry entry = enter_frame(settings_, image, t_ns, &frozen_, &frame_, &tracking_);
  if (entry == FrameEntry::kLate || entry == FrameEntry::kRepeated) return entry_status(entry, tracking_);
  begin_frame(t_ns);
  if (tracking_.started_over()) return end_frame();
  bool usable = entry == FrameEntry::kNew;
  if (usable) {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kPyramid]);
    usable = images_.begin_frame(image);
  }
  if (!usable) return unusable_status(end_frame());
  data_.image_usable = true;
  tracking_.note_usable_image(data_.since_last_ns);
  // W is the plan's as long as there are walls: a new map would begin somewhere else.
  if (tracking_.needs_new_map(settings_.restart_ns) && !map_.planes.has_known())
    begin_new_map("not found again for too long: the old map is discarded, a new map begins");
  const bool first = !tracking_.has_pose();
  update_.proposals().begin_frame(data_.since_last_ns);
  const ConsensusRule rule = consensus_rule(t_ns);
  if (first) {
    if (!start_.start_in_image()) return end_frame();
  } else if (tracking_.is_relocalising(start_.recorder().progress()) && rule == ConsensusRule::kBeyondChance) {
    relocaliser_.recover();
  } else {
    update_.ask_frames(tracking_.is_after_gap(start_.recorder().progress()) ? tuning::relocaliser::kFramesNearby : 0,
                       data_.median_depth);
    measure_watched(
        [&](bool) { images_.measure(rule, data_.median_depth, start_.recorder().learns_lens_from_first_depths()); });
    update_.ask_frames(0, data_.median_depth);
  }
  // Behind the points: a patch is found all the better where they have told the pose, and supports it where they have not.
  if (patches_ != nullptr && !first)
    patches_->measure(images_.tracker().pyramid(), start_.recorder().progress().checking);
  const bool supported = tracking_.is_tracked(frame_.report) || start_.recorder().progress().pending();
  if (!first && tracking_.is_tracked(frame_.report)) images_.learn_templates();
  {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kMap]);
    if (supported) count_searches(frame_, &map_.features);
    // While the map starts, residuals are those of a coarse map.
    if (supported && tracking_.state() == SlamState::kTracking && !start_.recorder().progress().recording)
      learn_noise();
    maintain_map(supported);
    if (start_.recorder().record_frame()) relocaliser_.init();  // its views have poses of the wrong map
    if (supported && !first) look_for_walls();
    const bool begins_anew = look_for_rest() && map_.features.count() == 0;
    // A frame that does not support its pose adds features only to a map that has none to lose.
    const bool empty = first || start_.recorder().progress().pending() || map_.features.count() == 0;
    if (tracking_.is_tracked(frame_.report) || (empty && frame_.report.attempts == 0) || begins_anew)
      images_.add_features();
    start_.recorder().begin_record();
  }
  if (patches_ != nullptr) patches_->maintain(images_.tracker().pyramid(), supported, may_begin_patches(first));
  return end_frame();
}

Status FilterSlam::push_observations(const PixelObservation* observations, int count, std::int64_t t_ns) {
  if (start_.takes_images_only()) return Status::kState;
  if (!is_next_frame(frame_, t_ns)) return Status::kTime;
  begin_frame(t_ns);
  if (tracking_.started_over()) return end_frame();
  if (!tracking_.has_pose()) start_.start_with_observations();
  measure_watched([&](bool again) { observations_.measure(observations, count, again); });
  {
    StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kMap]);
    maintain_map(true);
    look_for_rest();
    observations_.add_features(observations, count);
  }
  return end_frame();
}

Status FilterSlam::mark_pose() {
  if (!tracking_.has_pose()) return Status::kState;
  // A frame that does not support its pose changes nothing in the map.
  return mark_.set(frame_.report.t_ns, tracking_.state() == SlamState::kTracking, data_.filter_ns);
}

/// The map becomes as large as the first wall that is seen says it is: places and lengths of before no longer hold.
void FilterSlam::look_for_walls() {
  const Scalar scale = start_.look_for_walls();
  if (!(scale > Scalar(0))) return;
  planes_.meet_walls();
  data_.median_depth *= scale;
  relocaliser_.init();
}

Status FilterSlam::add_wall(const PlanePrior& prior, std::uint32_t* id) {
  if (!settings_.planes || !start_.has_place()) return Status::kState;
  const int reserved = tracking_.has_pose() ? 0 : start_.target_rows();
  const Status status =
      planes_.add_wall(prior, reserved, tracking_.state() == SlamState::kTracking, data_.filter_ns, id);
  if (status == Status::kOk && !map_.planes.has_apart()) start_.recorder().init();
  return status;
}

/// Begins the report and predicts the body to the new time.
void FilterSlam::begin_frame(std::int64_t t_ns) {
  const std::int64_t before_ns = data_.filter_ns;
  data_.filter_ns = t_ns;
  data_.since_last_ns = frame_.report.frames > 0 ? std::min(elapsed_ns(before_ns, t_ns), BodyMotion::kMaxGapNs) : 0;
  data_.image_usable = false;
  const bool nothing_measured = frame_.report.inliers == 0;
  data_.follows = tracking_.has_pose() && !tracking_.coasting_or_lost() && !start_.recorder().progress().pending();
  frame_.begin(t_ns);
  if (data_.map_discredited) begin_new_map("the map's scale came from a unit that is doubted: a new map begins");
  tracking_.begin_frame();
  if (!tracking_.has_pose()) {
    motion_.init();  // control input is for one frame only
    return;
  }
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[settings_.inertial ? kImu : kPredict]);
  watch_.begin_frame(before_ns, t_ns);
  if (unit_ == nullptr || !unit_->hold.predict(data_.follows, before_ns, t_ns, data_.median_depth))
    advance(before_ns, tracking_.coasting_or_lost(), nothing_measured);
  if (!filter_.body_is_sound()) start_over();
}

/// A match along a ray whose depth is open passes nearly everywhere, so not every right frame is beyond chance while fewer features have a
/// depth of their own than a tracked frame needs. A map as young as that is tracked from frame to frame, and not found again after a gap.
ConsensusRule FilterSlam::consensus_rule(std::int64_t t_ns) const {
  if (start_.recorder().progress().pending()) return ConsensusRule::kStart;
  const std::int64_t proposed_ns = update_.proposals().last().frames > 0 ? data_.since_last_ns : 0;
  const double gap_s = seconds(elapsed_ns(tracking_.last_tracked_ns(), t_ns) - proposed_ns);
  if (tracking_.is_relocalising(start_.recorder().progress()) &&
      gap_s > static_cast<double>(tuning::tracking::kMaxYoungGap))
    return ConsensusRule::kBeyondChance;
  int known = 0;
  for (int i = 0; i < map_.features.capacity() && known < settings_.min_inliers; ++i)
    known += map_.features.used(i) && filter_.state().block[map_.features[i].slot].kind != BlockKind::kInverseDepth;
  if (known < settings_.min_inliers) return ConsensusRule::kMostAgree;
  const bool follows = tracking_.is_followed() && gap_s <= static_cast<double>(tuning::tracking::kMaxYoungGap);
  return follows ? ConsensusRule::kFollowed : ConsensusRule::kBeyondChance;
}

/// As for features: a frame that does not support its pose begins patches only where there is nothing that could be found again.
bool FilterSlam::may_begin_patches(bool first) const {
  if (start_.recorder().progress().recording) return false;
  const bool empty = first || (map_.features.count() == 0 && patches_->patches().count() == 0);
  return tracking_.is_tracked(frame_.report) || (empty && frame_.report.attempts == 0);
}

/// measure(again): where a rest or samples may have led the prediction astray, once more from one without them.
template <typename F>
void FilterSlam::measure_watched(F&& measure) {
  bool again = false;
  if (holds()) {
    watch_.begin_measuring(data_.follows);
    measure(again);
    if (!watch_.is_refused()) return;
    unit_->hold.take_back();
    advance(unit_->hold.before_ns(), false, false);
    frame_.begin_again();
    again = true;
  }
  watch_.begin_measuring(data_.follows);
  const bool just_moved = unit_ != nullptr && unit_->hold.has_just_ended(frame_.report.t_ns);
  update_.put_depths_first(just_moved);
  measure(again);
  if (just_moved && !update_.puts_depths_first()) unit_->hold.forget();
  update_.put_depths_first(false);
  if (!watch_.is_refused()) return;
  watch_.leave_prediction();
  frame_.begin_again();
  measure(true);
  watch_.settle(tracking_.is_tracked(frame_.report));
}

void FilterSlam::learn_noise() {
  images_.learn_noise();
  data_.warnings.check(settings_, noise_, filter_.lens());
}

/// If the frame does not support its pose, nothing is decided about the map.
void FilterSlam::maintain_map(bool supported) {
  mark_.drop_unsound();
  if (!supported) {
    features_.drop_failing(false);
    return;
  }
  features_.convert_linear();
  // During a start the filter may restart without planes; ids of planes found before would then name nothing.
  if (settings_.planes && !start_.recorder().progress().recording)
    planes_.maintain(!start_.recorder().progress().checking);
  features_.drop_failing(true);
}

/// Returns the status of the frame.
Status FilterSlam::end_frame() {
  watch_unit();
  if (tracking_.has_pose() && (tracking_.updates_fail() || !repair_covariance() || !filter_.body_is_sound()))
    start_over();
  if (tracking_.is_tracked(frame_.report) && !start_.recorder().progress().pending()) {
    Scalar patch_depth[PatchKeeper::kMaxPatches];
    const int patches = patches_ != nullptr ? patches_->inlier_depths(patch_depth) : 0;
    if (!is_pose_usable(filter_, map_, frame_, patch_depth, patches, &data_.median_depth))
      tracking_.set_unusable();
    else if (data_.image_usable)
      relocaliser_.remember_view(data_.median_depth);
  }
  images_.note_view(tracking_.is_tracked(frame_.report) && !start_.recorder().progress().recording, data_.median_depth);
  if (data_.image_usable && frame_.report.inliers > 0) images_.keep_view();
  return tracking_.conclude(frame_.report, start_.recorder().progress(), settings_.max_coast_ns, settings_.hooks);
}

/// False where P is no covariance and nothing helps.
bool FilterSlam::repair_covariance() {
  const BlockFilter::Repair repair = filter_.repair(frame_.report.frames);
  if (repair == BlockFilter::Repair::kDone) count_frame(&frame_.report.repairs);
  return repair != BlockFilter::Repair::kImpossible;
}

/// The estimate is not finite or P is no covariance: clears everything that came from it.
void FilterSlam::start_over() {
  clear_estimate();
  tracking_.start_over();
  settings_.hooks.say("the estimate is no longer finite: starting again without it");
}

/// The map was not found again for too long, although the images were usable, or its scale is discredited: a new one begins with this
/// frame.
void FilterSlam::begin_new_map(const char* why) {
  if (!data_.map_discredited && tracking_.has_pose()) start_.mounting().keep();
  clear_estimate();
  tracking_.begin_map();
  data_.map_discredited = false;
  settings_.hooks.say(why);
}

void FilterSlam::clear_estimate() {
  start_.start_over();
  metric_.init();
  map_.features.clear();
  motion_.init();
  rest_.init();
  init_unit();
  images_.forget_map();
  relocaliser_.init();
  frame_.forget_all();
}

}  // namespace pf
