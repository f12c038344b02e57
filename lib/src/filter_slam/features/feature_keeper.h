#pragma once

#include "filter/filter.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "frame/start/start.h"
#include "map/map.h"

/// Keeps the features of the map: adds, converts, drops and evicts them, each together with its block in the filter.

namespace pf {

class FeatureKeeper {
 public:
  FeatureKeeper(const Settings& settings, Filter& filter, Map& map, Frame& frame)
      : settings_(settings), filter_(filter), map_(map), frame_(frame) {}

  bool layout(Arena& arena, int max_features);

  /// Converts inverse depths whose linearity index is small enough to 3-D points.
  void convert_linear();
  /// Drops features that fail too often, lie behind their first camera, or whose values are not finite and bounded.
  /// In a frame that does not support its pose only features with unsound values: one that was not found may still be there.
  void drop_failing(bool is_tracked);
  void drop(const int* entries, int count);
  void drop_all();
  /// Removes a table entry whose block is no longer in the filter.
  void release(int entry);

  /// Frees so many rows by evicting features that were not seen since this time. False, with nothing changed, where these are too few.
  bool make_rows(int rows, std::int64_t not_since_ns);
  /// Makes room for one more feature on *anchor, and a new anchor if *anchor is -1 or was removed by an eviction. False: no room.
  bool make_room_at(int* anchor);
  /// The same for a feature that begins on a plane.
  bool make_room_on_plane() { return make_room(2); }
  /// The same for a 3-D point.
  bool make_room_for_point() { return make_room(3); }
  /// Adds an inverse-depth feature at a pixel. Returns its table entry, or -1.
  int add(int anchor, const Vec2& pixel, const Mat2& noise);
  /// Slot of the nearest established plane that the pixel's ray meets inside of its outline, or -1.
  int plane_at(const Vec2& pixel) const;
  /// Adds a feature at a pixel that is taken to lie on this plane, on trial. Returns its table entry, or -1.
  int add_on_plane(int plane, const Vec2& pixel, const Mat2& noise);
  /// Adds the target's points to the state with their own uncertainty.
  void add_target_points(const Target& target);
  /// Adds one of them to the filter alone. Returns its slot, or -1.
  int add_target_point(const Target& target, int index);

 private:
  bool make_room(int rows);
  int add_entry(int slot);
  Scalar median_inverse_depth() const;

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  int* scratch_ = nullptr;  ///< max_features
};

}  // namespace pf
