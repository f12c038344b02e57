#include "base/elapsed.h"
#include "filter_slam/features/image_front_end.h"

namespace pf {

/// With the pose after the update, and where the features were found.
void ImageFrontEnd::learn_templates() {
  if (!search_.has_templates() || !is_measured_) return;
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kTemplate]);
  for (int i = 0; i < listed_; ++i) {
    const Candidate& candidate = update_.candidate(i);
    const Match& match = frame_.match(candidate.match);
    if (match.status != MatchStatus::kInlier || match.feature < 0) continue;
    SearchTask task = task_of(candidate.feature);
    task.predicted = match.measured;
    if (!search_.learn(task, match.measured, &map_, candidate.feature)) continue;
    const PlanarTemplate& shape = map_.shape(candidate.feature);
    ++frame_.report.templates;
    frame_.report.template_area += shape.area / static_cast<float>(shape.side * shape.side);
  }
}

}  // namespace pf
