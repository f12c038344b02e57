#pragma once

#include "base/arena.h"
#include "frame/fixed_features.h"
#include "frame/settings.h"
#include "map/map.h"
#include "track/tracker.h"

/// Comparing features with an image, by the tracker or by templates with masks. Knows no back end.

namespace pf {

class Archive;

class TemplateMatcher;

class ImageSearch {
 public:
  /// Without masks in the config templates take no memory.
  bool layout(Arena& arena, const Settings& settings);
  void init(const Settings& settings);

  /// Prepares an image for the search. False if it shows nothing to track: black, white or blurred.
  bool begin_frame(const ImageView& image);
  /// Stores the pixels around this pixel as the feature's appearance. False if the pixel is too near to the border.
  bool remember(Map* map, int feature, const Vec2& pixel, const CameraView& view) const;
  /// Makes a task search with the feature's template. Only for points with a depth.
  static void use_template(const Map& map, int feature, SearchTask* task);
  /// Searches for a feature in the image. Where it is predicted or found at masked pixels it counts as not comparable.
  SearchOutcome search(const SearchTask& task) const;
  /// Updates mask and normal of the template of a feature that was found at this pixel. False where they do not change.
  bool learn(const SearchTask& task, const Vec2& pixel, Map* map, int feature) const;

  /// After a frame's searches: masks what stands still in the image from the next frame on. True where the map has come from it.
  bool note_fixed(const Camera& camera, const KnownScene* scene, Frame* frame, FeatureTable* features) {
    return fixed_.note(camera, scene, frame, features);
  }
  FixedFeatures& fixed() { return fixed_; }

  bool has_templates() const { return templates_ != nullptr; }
  const Tracker& tracker() const { return tracker_; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  Tracker tracker_;
  FixedFeatures fixed_;
  PartPointer<TemplateMatcher, kHasMasks> templates_;  ///< in the block, with masks alone
};

}  // namespace pf
