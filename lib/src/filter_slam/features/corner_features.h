#pragma once

#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/features/feature_search.h"
#include "frame/corner_cells.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "map/map.h"

/// Adds features to the map at corners of the image.

namespace pf {

class CornerFeatures {
 public:
  CornerFeatures(const Settings& settings, Filter& filter, Map& map, Frame& frame, FeatureKeeper& features,
                 FeatureSearch& search)
      : settings_(settings), filter_(filter), map_(map), frame_(frame), features_(features), search_(search) {}

  /// Adds features in the emptiest cells of the image until enough are in view.
  void add();
  /// Adds features at these pixels, at which others have just left the map.
  void add_at(const Vec2* pixel, int count);

 private:
  bool add_in(const Rect& rect, const CornerStrength& least, int* anchor);
  CornerUse add_one(const Vec2& pixel, int* anchor);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  FeatureKeeper& features_;
  FeatureSearch& search_;
};

}  // namespace pf
