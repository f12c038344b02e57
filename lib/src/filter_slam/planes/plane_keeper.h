#pragma once

#include <cstdint>

#include "base/status.h"
#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/planes/certain_points.h"
#include "filter_slam/planes/own_places.h"
#include "filter_slam/planes/plane_discovery.h"
#include "filter_slam/planes/plane_points.h"
#include "filter_slam/planes/vertical_table.h"
#include "filter_slam/planes/walls/wall_folding.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "map/map.h"

namespace pf {

class Archive;

/// Keeps the planes of the map: the order of work of one frame. Gee 2007, section 3 (lib/docs/theory/planes.md).
class PlaneKeeper {
 public:
  PlaneKeeper(const Settings& settings, Filter& filter, Map& map, Frame& frame, FeatureKeeper& features);
  PlaneKeeper(const PlaneKeeper&) = delete;  // its parts refer to each other
  PlaneKeeper& operator=(const PlaneKeeper&) = delete;

  bool layout(Arena& arena, int max_features);
  void init();

  /// Adds a wall; so many rows stay free beside it. Rows are made free by evicting features that were not seen since not_since_ns, where
  /// features may go. kFull: no room for it; nothing has changed then.
  Status add_wall(const PlanePrior& prior, int reserved_rows, bool may_evict, std::int64_t not_since_ns,
                  std::uint32_t* id);
  /// Walls are compared with the map for the first time: planes that were found in a map of another size end, since their points would
  /// not fold into walls, and those before a wall fold into it.
  void meet_walls();
  /// The map's lengths have been multiplied by s, about W's origin: what is kept of lengths beside filter and map follows.
  void scale(Scalar s) { places_.scale(s); }

  /// The work of one frame. Folds, fixes and merges one plane per frame, in turn, so that the work is bounded. may_doubt: the map's
  /// depths are known well enough to reject a wall.
  void maintain(bool may_doubt = true);

  /// Planes that the caller says are vertical. Only where the state has gravity.
  VerticalTable& verticals() { return verticals_; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  void maintain_plane(int entry, bool may_doubt);
  void judge_wall(int entry);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  FeatureKeeper& features_;
  OwnPlaces places_;
  CertainPoints certain_;
  PlaneDiscovery discovery_;
  WallFolding walls_;
  VerticalTable verticals_;
};

}  // namespace pf
