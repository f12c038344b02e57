#pragma once

#include <algorithm>
#include <cstdint>

#include "filter/filter.h"
#include "map/map.h"
#include "track/patch_store.h"

namespace pf {

class Archive;

/// Stores where patches of a plane were found elsewhere, and counts them as evidence against the plane.
class PatchRefusals {
 public:
  PatchRefusals(const Filter& filter, Map& map) : filter_(filter), map_(map) {}

  void init();

  /// Notes a patch of this wall that the gate rejects.
  void note(const StoredPatch& patch, int wall);
  /// Notes a frame in which the patch is measured on another plane, though the plan has a wall before it (hiding; -1: none). Five such
  /// frames in a row are evidence against this wall, since it is seen through. is_contested: nothing supports the pose of this frame, which
  /// is then no evidence against a wall.
  void count_through(StoredPatch* patch, int hiding, const Vec3& middle_W, bool is_contested);

  /// Calls f(middle_W) for each stored patch that was evidence against the plane with this id.
  template <typename F>
  void for_each(std::uint32_t plane, F&& f) const {
    for (const Refusal& refusal : refusals_)
      if (refusal.plane == plane) f(refusal.middle_W);
  }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  static constexpr int kMaxRefusals = 16;
  struct Refusal {
    std::uint32_t plane = 0;  ///< id; 0: none
    int born = 0;             ///< frame in which the patch began
    Vec3 middle_W;
  };

  /// Whether a patch that began in the same frame has already been evidence against the plane: they share a reference camera, and its
  /// error.
  bool is_told_already(std::uint32_t plane, int born) const;
  /// Whether two views of the patch show that it is before the wall.
  bool is_before(const StoredPatch& patch, int wall) const;
  /// Stores it in place of the oldest.
  void keep(const Refusal& refusal);

  const Filter& filter_;
  Map& map_;
  Refusal refusals_[kMaxRefusals];  ///< the last ones
  int next_refusal_ = 0;
};

}  // namespace pf
