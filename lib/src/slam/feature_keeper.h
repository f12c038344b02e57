#pragma once

#include "filter/filter.h"
#include "map/map.h"
#include "slam/frame.h"
#include "slam/settings.h"
#include "slam/start.h"

/// Keeps the features of the map: begins, converts, drops and evicts them, each together with its block in the filter.

namespace pf {

class FeatureKeeper {
 public:
  FeatureKeeper(const Settings& settings, Filter& filter, Map& map, Frame& frame)
      : settings_(settings), filter_(filter), map_(map), frame_(frame) {}

  bool layout(Arena& arena, int max_features);

  /// Inverse depths that have become linear become 3-D points.
  void convert_linear();
  /// Features go that fail too often, whose depth is negative, or whose numbers are unsound.
  void drop_failing();
  void drop(const int* entries, int count);
  void drop_all();
  /// A table entry goes whose block in the filter is gone already.
  void release(int entry);

  /// Room for one more feature on an anchor, which is made where there is none: evictions take a childless anchor along.
  bool make_room_at(int* anchor);
  /// A new inverse-depth feature at a pixel; its table entry, or -1.
  int add(int anchor, const Vec2& pixel, const Mat2& noise);
  /// The target's points enter the state with their own uncertainty.
  void add_target_points(const Target& target);

 private:
  bool make_room(int rows);
  Scalar median_inverse_depth() const;

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  int* scratch_ = nullptr;  ///< max_features
};

}  // namespace pf
