#include "frame/image_search.h"

#include "track/template_matcher.h"

namespace pf {

bool ImageSearch::layout(Arena& arena, const Settings& settings) {
  if (kHasMasks && settings.masks != MaskMode::kNone)
    templates_ = arena.place<TemplateMatcher>([&](TemplateMatcher& made) { made.layout(arena, settings.template_px); });
  fixed_.layout(arena, settings.camera.width, settings.camera.height, settings.max_features);
  return tracker_.layout(arena, settings.camera.width, settings.camera.height);
}

void ImageSearch::init(const Settings& settings) {
  fixed_.init(settings.mask.mask);
  tracker_.init(settings.camera, fixed_.mask());
  if (has_templates()) templates_->init(settings.camera, settings.masks, settings.max_misfit);
}

bool ImageSearch::begin_frame(const ImageView& image) {
  if (has_templates()) templates_->begin_frame();
  return tracker_.begin_frame(image);
}

bool ImageSearch::remember(Map* map, int feature, const Vec2& pixel, const CameraView& view) const {
  Feature& f = map->features[feature];
  f.has_appearance = tracker_.remember(pixel, &map->appearance(feature));
  map->first_view(feature) = view;
  if (f.has_appearance && has_templates())
    templates_->begin(tracker_.image(), map->appearance(feature).patch, pixel, &map->shape(feature),
                      map->mask(feature));
  return f.has_appearance;
}

void ImageSearch::use_template(const Map& map, int feature, SearchTask* task) {
  task->shape = &map.shape(feature);
  task->mask = map.mask(feature);
}

SearchOutcome ImageSearch::search(const SearchTask& task) const {
  if (!tracker_.is_in_scene(task.predicted)) return SearchOutcome();
  const bool has_template = has_templates() && task.shape != nullptr;
  const SearchOutcome outcome = has_template ? templates_->search(tracker_, task) : tracker_.search(task);
  return outcome.found && !tracker_.is_in_scene(outcome.pixel, outcome.level_scale) ? SearchOutcome() : outcome;
}

bool ImageSearch::learn(const SearchTask& task, const Vec2& pixel, Map* map, int feature) const {
  return has_templates() && task.shape != nullptr &&
         templates_->learn(tracker_, task, pixel, &map->shape(feature), map->mask(feature));
}

}  // namespace pf
