#pragma once

#include "map/feature_table.h"
#include "map/plane_table.h"

/// The map beside the filter: what is kept about features and planes, as plain tables behind one handle.

namespace pf {

struct Map {
  FeatureTable features;
  PlaneTable planes;
  bool target_withdrawn = false;  ///< the target's points are measured no more

  bool layout(Arena& arena, int max_features, int max_planes) {
    features.layout(arena, max_features);
    planes.layout(arena, max_planes);
    return arena.ok();
  }
  void init() {
    features.init();
    planes.init();
    target_withdrawn = false;
  }
};

}  // namespace pf
