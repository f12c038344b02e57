#pragma once

#include <cstdint>

#include "base/arena.h"
#include "base/status.h"
#include "filter/filter.h"
#include "filter/vertical.h"
#include "map/map.h"

namespace pf {

class Archive;

/// Planes that the caller states to be vertical (lib/docs/theory/inertial.md). How far a plane is from vertical is a constant, so stating
/// it again adds no information.
class VerticalTable {
 public:
  VerticalTable(Filter& filter, const Map& map) : filter_(filter), map_(map) {}

  /// Only where gravity is estimated; else there is no table.
  bool layout(Arena& arena);
  void init();

  /// A plane of the table is vertical within sigma [rad], which counts once; 0 forgets it. kRange: what is known of plane and gravity
  /// contradicts it; nothing has changed then.
  Status tell(int plane_entry, Scalar sigma);
  /// Plane `from` is merged into `to`, which takes over its row, unless it has one already.
  void merge(int from, int to);

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// That a plane is vertical.
  struct Told {
    std::uint32_t id = 0, generation = 0;  ///< of the plane, and of the filter then
    VerticalRow row;
  };
  /// The row of a plane, in the map as it is.
  VerticalRow* row(int plane_entry);

  Filter& filter_;
  const Map& map_;
  Told* told_ = nullptr;  ///< of each entry; null where gravity is not estimated
};

}  // namespace pf
