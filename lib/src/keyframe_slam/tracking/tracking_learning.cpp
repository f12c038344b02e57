#include "base/elapsed.h"
#include "frame/tuning.h"
#include "keyframe_slam/tracking/tracking.h"

/// What KeyframeTracking learns from a tracked frame: the noise of matches, and templates.

namespace pf {

void KeyframeTracking::learn_noise() {
  const PosePrior at = now();
  for (int c = 0; c < listed_; ++c) {
    const Match& match = frame_.match(candidate_[c].match);
    ExpectedPixel expected;
    if (match.status != MatchStatus::kInlier || match.feature < 0) continue;
    Feature& f = map_.feature(match.feature);
    if (f.observations < tuning::image_front_end::kSettled || !expect_placed(match.feature, at, &expected)) continue;
    const Scalar leverage = expected.spread.trace() / (noise_.correlation_frames() * candidate_[c].noise.trace());
    noise_.learn(frame_.report.frames, match.measured - expected.pixel, candidate_[c].noise, leverage,
                 f.is_target ? nullptr : &f.residuals);
  }
  noise_.end_frame();
}

void KeyframeTracking::learn_templates() {
  if (!search_.has_templates()) return;
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kTemplate]);
  const PosePrior at = now();
  for (int c = 0; c < listed_; ++c) {
    const Match& match = frame_.match(candidate_[c].match);
    if (match.status != MatchStatus::kInlier || match.feature < 0) continue;
    SearchTask task = task_of(match.feature, at, Scalar(1));
    task.predicted = match.measured;
    if (!search_.learn(task, match.measured, &map_.tables(), match.feature)) continue;
    const PlanarTemplate& shape = map_.tables().shape(match.feature);
    ++frame_.report.templates;
    frame_.report.template_area += shape.area / static_cast<float>(shape.side * shape.side);
  }
}

}  // namespace pf
