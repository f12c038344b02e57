#include "filter_slam/image_tracking.h"

#include "base/elapsed.h"
#include "frame/tuning.h"

namespace pf {

bool ImageTracking::layout(Arena& arena, FilterMemory* memory) {
  front_end_.layout(arena, settings_.max_observations);
  return relocaliser_.layout(arena, settings_.max_observations, settings_.kept.views, memory);
}

void ImageTracking::init() {
  front_end_.init();
  relocaliser_.init();
  noise_.init(settings_.sigma_px);
  warnings_ = FitWarnings();
  is_map_fixed_ = false;
}

void ImageTracking::forget_map() {
  is_map_fixed_ = false;
  front_end_.search().forget_view();
  relocaliser_.init();
}

UpdateOutcome ImageTracking::recover_or_measure(const MeasureMode& mode, bool is_lost) {
  MeasureMode now = mode;
  now.is_vague = is_lost && !relocaliser_.is_prediction_narrow();
  if (now.is_vague) tracking_.belief().spend();
  UpdateOutcome outcome = front_end_.measure(now);
  if (now.is_vague && frame_.report.inliers == 0) outcome = relocaliser_.recover(now, outcome);
  is_map_fixed_ = front_end_.search().note_fixed(tracking_.has_pose() && frame_.report.inliers > 0);
  return outcome;
}

void ImageTracking::learn_noise() {
  front_end_.learn_noise();
  warnings_.check(settings_, noise_, filter_.lens());
}

void ImageTracking::keep_view(bool image_usable, const StartProgress& start, Scalar median_depth) {
  front_end_.note_view(tracking_.is_tracked(frame_.report) && !start.recording, median_depth);
  if (image_usable && frame_.report.inliers > 0) front_end_.search().keep_view();
  front_end_.search().follow(frame_.correction.T);
}

}  // namespace pf
