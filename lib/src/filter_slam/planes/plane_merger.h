#pragma once

#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/planes/vertical_table.h"
#include "frame/settings.h"
#include "map/map.h"

namespace pf {

/// Merges planes that are the same. Gee 2007, section 3.3. Keeps nothing; constructed where it is used.
class PlaneMerger {
 public:
  PlaneMerger(const Settings& settings, Filter& filter, Map& map, FeatureKeeper& features, VerticalTable& verticals)
      : settings_(settings), filter_(filter), map_(map), features_(features), verticals_(verticals) {}

  /// Merges one other plane that is the same into this one.
  void merge_into(int plane_entry);

 private:
  /// Whether the points of plane `other` (block) lie on an entry's plane. A wall may be far from where the plan has it, by its own
  /// variance.
  bool is_same_plane(int entry, int other) const;
  /// Folds the points of one plane into another, as far as they pass the gate. False if a fixed point could not be released first.
  bool give_points(int from_entry, int to_entry);
  /// Extends the outline of a plane by that of another one.
  void give_outline(int from_entry, int to_entry);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  FeatureKeeper& features_;
  VerticalTable& verticals_;
};

}  // namespace pf
