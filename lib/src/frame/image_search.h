#pragma once

#include "base/arena.h"
#include "frame/fixed_features.h"
#include "frame/settings.h"
#include "map/map.h"
#include "track/tracker.h"

/// Comparing features with an image, by the tracker or by templates with masks. Knows no back end.

namespace pf {

class TemplateMatcher;

class ImageSearch {
 public:
  /// Templates take nothing where the config has no masks.
  bool layout(Arena& arena, const Settings& settings);
  void init(const Settings& settings);

  /// Prepares an image for the search. False if it shows nothing to track: black, white or blurred.
  bool begin_frame(const ImageView& image);
  /// Stores how a feature looks at this pixel of the image. False if the pixel is too near to the border.
  bool remember(Map* map, int feature, const Vec2& pixel, const CameraView& view) const;
  /// Lets a task search with the feature's template. Its point has a depth.
  static void use_template(const Map& map, int feature, SearchTask* task);
  /// What is expected at something that is masked, or found there, cannot be compared.
  SearchOutcome search(const SearchTask& task) const;
  /// Updates mask and normal of a feature's template, which was found at this pixel. False where nothing was learnt.
  bool learn(const SearchTask& task, const Vec2& pixel, Map* map, int feature) const;

  /// After a frame's searches: leaves out what stands still in the picture from the next one on. True where the map comes from that.
  bool note_fixed(const Camera& camera, const Frame& frame, FeatureTable* features) {
    return fixed_.note(camera, frame, features);
  }

  bool has_templates() const { return templates_ != nullptr; }
  const Tracker& tracker() const { return tracker_; }

 private:
  Tracker tracker_;
  FixedFeatures fixed_;
  PartPointer<TemplateMatcher, kHasMasks> templates_;  ///< in the block, with masks alone
};

}  // namespace pf
