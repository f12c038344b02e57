#pragma once

#include <cstdint>

#include "base/arena.h"
#include "filter/filter.h"
#include "filter_slam/planes/certain_points.h"
#include "frame/settings.h"
#include "map/map.h"
#include "map/plane_search.h"

namespace pf {

/// Finds new planes among points that lie on none. Gee 2007, section 3.3.
class PlaneDiscovery {
 public:
  PlaneDiscovery(const Settings& settings, Filter& filter, Map& map, const CertainPoints& certain)
      : settings_(settings), filter_(filter), map_(map), certain_(certain) {}

  bool layout(Arena& arena, int max_features);
  void init() { searches_ = 0; }

  /// Looks for one new plane.
  void discover();

 private:
  /// Lists converged, well known points that lie on no plane yet. Returns how many.
  int list_candidates();

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  const CertainPoints& certain_;
  PlaneCandidate* candidate_ = nullptr;  ///< max_features; their names are entries of the feature table
  std::uint32_t searches_ = 0;           ///< so far
};

}  // namespace pf
