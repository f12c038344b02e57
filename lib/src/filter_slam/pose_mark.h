#pragma once

#include "base/status.h"
#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "map/map.h"

/// The pose that the caller marked: a reference camera of the filter that stays until the next mark or the end of the map.

namespace pf {

class PoseMark {
 public:
  PoseMark(Filter& filter, Map& map, FeatureKeeper& features) : filter_(filter), map_(map), features_(features) {}

  /// Marks the filter's pose under this time, in place of an older mark. With may_evict, features that were not seen since not_since_ns are
  /// evicted to make room. kFull: there is no room; nothing has changed then.
  Status set(std::int64_t t_ns, bool may_evict, std::int64_t not_since_ns);
  /// Removes a mark whose numbers are no longer finite and bounded.
  void drop_unsound();

 private:
  static constexpr int kRows = 6;

  void remove();

  Filter& filter_;
  Map& map_;
  FeatureKeeper& features_;
};

}  // namespace pf
