#pragma once

#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/planes/certain_points.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "map/map.h"

namespace pf {

/// Decides when a wall of the plan is rejected, and when it is accepted again (lib/docs/theory/walls.md). Keeps nothing; constructed where
/// it is used.
class WallDoubt {
 public:
  WallDoubt(const Settings& settings, Filter& filter, Map& map, const Frame& frame, FeatureKeeper& features,
            const CertainPoints& certain)
      : settings_(settings), filter_(filter), map_(map), frame_(frame), features_(features), certain_(certain) {}

  /// Counts what is seen inside of the wall's outline: points that lie on it, and points that the gate rejects. Rejects the wall where far
  /// more are rejected; accepts it again when most of them lie on it. Points behind it are seen through it. Points before it
  /// may be things that stand there, and count only where they leave too little of the wall to be seen.
  void judge(int plane_entry);

 private:
  /// Removes what the wall's prior has contributed, and unfolds the wall's points.
  void doubt(int plane_entry);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  const Frame& frame_;
  FeatureKeeper& features_;
  const CertainPoints& certain_;
};

}  // namespace pf
