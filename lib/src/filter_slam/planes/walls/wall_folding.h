#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "filter_slam/planes/certain_points.h"
#include "frame/settings.h"
#include "map/map.h"

namespace pf {

class Archive;

/// Folds points onto walls of the plan that none of them alone is known to lie on. Servant 2008, section 2.2 (lib/docs/theory/walls.md).
class WallFolding {
 public:
  WallFolding(const Settings& settings, Filter& filter, Map& map, const CertainPoints& certain)
      : settings_(settings), filter_(filter), map_(map), certain_(certain) {}

  void init() { data_ = Data(); }
  /// Walls came into view in a map of unknown size.
  void note_late_walls() { data_.met_late = true; }
  /// Folds the points that agree with each other and with the wall's prior.
  void fold_by_consensus(int plane_entry);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// What is kept between frames.
  struct Data {
    std::uint32_t random = 1;  ///< of what is drawn before walls
    bool met_late = false;
  };

  /// Lists converged points before the wall that are known well enough, in random order. Returns how many.
  int list_before_wall(int plane_entry, int* slots, int capacity);
  /// Whether the world's scale is known, or this wall has as many points before it as any other. As long as the scale is not known, points
  /// before a wall that is not there agree with it as well as with one that is, only in a world of another size; so the wall that most
  /// points are before decides.
  bool may_set_scale(int plane_entry) const;
  /// Whether a point is one of a plane that was found, which cannot merge into a wall that came into view late while the scale is open: it
  /// is where the wall is only in a map of the right size.
  bool is_on_found_plane(int entry) const;
  /// The largest set of these points (a bit each) that agree that they lie on the wall (find_wall_consensus).
  unsigned find_consensus(int plane_entry, const int* slots, int count, int* size);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  const CertainPoints& certain_;
  Data data_;
};

}  // namespace pf
