#pragma once

#include <cstdint>

#include "base/arena.h"
#include "filter/filter.h"
#include "filter_slam/planes/certain_points.h"
#include "filter_slam/planes/own_places.h"
#include "frame/settings.h"
#include "frame/tuning.h"
#include "map/map.h"
#include "map/plane_search.h"

namespace pf {

class Archive;

/// Finds new planes among points that lie on none. Gee 2007, section 3.3.
class PlaneDiscovery {
 public:
  PlaneDiscovery(const Settings& settings, Filter& filter, Map& map, const CertainPoints& certain, OwnPlaces& places)
      : settings_(settings), filter_(filter), map_(map), certain_(certain), places_(places) {}

  bool layout(Arena& arena, int max_features);
  void init() { searches_ = 0; }

  /// Looks for one new plane.
  void discover();
  /// Whether there are planes that the map had when it began again, and that have not been found since.
  bool has_lost() const { return next_lost(0) != 0; }
  /// Finds them again, from the points that were on them. Each is tested as a new one, and keeps its id. One is given up where no plane is
  /// found though most of its points are known again.
  void resume();

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// Lists converged, well known points that lie on no plane yet. Returns how many.
  int list_candidates();
  std::uint32_t next_lost(std::uint32_t above) const;
  bool resume_plane(std::uint32_t id, int count);
  /// Takes a plane that the search has found, if the filter's own covariance says so too. id: of one that goes on; 0: it is new.
  bool take(const PlaneFit& fit, int* member, int members, std::uint32_t id);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  const CertainPoints& certain_;
  OwnPlaces& places_;
  PlaneCandidate* candidate_ = nullptr;  ///< max_features; their names are entries of the feature table
  std::uint32_t searches_ = 0;           ///< so far
};

}  // namespace pf
