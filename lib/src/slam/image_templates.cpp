#include <new>

#include "base/elapsed.h"
#include "slam/image_front_end.h"
#include "track/template_matcher.h"

namespace pf {

/// Without masks it takes nothing.
bool ImageFrontEnd::layout_templates(Arena& arena) {
  if (settings_.masks == MaskMode::kNone) return arena.ok();
  TemplateMatcher* place = arena.take<TemplateMatcher>(1);
  if (place == nullptr) return TemplateMatcher().layout(arena, settings_.template_px);
  templates_ = new (place) TemplateMatcher();
  return templates_->layout(arena, settings_.template_px);
}

/// With the pose after the update, and where the features were found.
void ImageFrontEnd::learn_templates() {
  if (templates_ == nullptr || !is_measured_) return;
  StageTimer timer(settings_.hooks, &frame_.report.stage_ns[kTemplate]);
  for (int i = 0; i < listed_; ++i) {
    const Candidate& candidate = update_.candidate(i);
    const Match& match = frame_.match(candidate.match);
    if (match.status != MatchStatus::kInlier || match.feature < 0) continue;
    SearchTask task = task_of(candidate.feature);
    task.predicted = match.measured;
    PlanarTemplate& shape = map_.shape(candidate.feature);
    if (task.shape == nullptr ||
        !templates_->learn(tracker_, task, match.measured, &shape, map_.mask(candidate.feature)))
      continue;
    ++frame_.report.templates;
    frame_.report.template_area += shape.area / static_cast<float>(shape.side * shape.side);
  }
}

}  // namespace pf
