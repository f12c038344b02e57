#pragma once

#include "filter/filter.h"
#include "map/map.h"
#include "slam/feature_keeper.h"
#include "slam/frame.h"
#include "slam/pixel_update.h"
#include "slam/settings.h"
#include "track/tracker.h"

/// Measures an image: predicts which features are in it and where, finds them, updates the filter, and adds features at corners.

namespace pf {

class ImageFrontEnd {
 public:
  ImageFrontEnd(const Settings& settings, Filter& filter, Map& map, Frame& frame, FeatureKeeper& features,
                PixelUpdate& update)
      : settings_(settings), filter_(filter), map_(map), frame_(frame), features_(features), update_(update) {}

  bool layout(Arena& arena, int width, int height);
  void init(const Camera& camera) { tracker_.init(camera); }

  /// Prepares an image for the search. False if it shows nothing to track: black, white or blurred.
  bool begin_frame(const ImageView& image) { return tracker_.begin_frame(image); }
  /// Finds the map's features in the image and updates the filter with them.
  void measure();
  /// Adds features in the emptiest cells of the image until enough are in view.
  void add_features();
  /// Stores how a feature looks at this pixel of the image. False if the pixel is too near to the border.
  bool remember(int feature, const Vec2& pixel, const CameraView& view);

  const Tracker& tracker() const { return tracker_; }

 private:
  // image_front_end.cpp
  int list_visible();
  bool is_visible(int feature) const;
  void predict_pixels(int first, int count);
  Scalar widest_ellipse(int count) const;
  SearchTask task_of(int i) const;
  int search(int first, int count);
  void measure_range(int first, int count);

  // image_corners.cpp
  bool is_free(const Vec2& pixel) const;
  bool add_in(const Rect& rect, int* anchor);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  FeatureKeeper& features_;
  PixelUpdate& update_;
  Tracker tracker_;
};

}  // namespace pf
