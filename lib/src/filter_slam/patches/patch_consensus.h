#pragma once

#include <cstdint>

#include "base/limits.h"
#include "filter/filter.h"
#include "filter_slam/patches/patch_finder.h"
#include "filter_slam/patches/patch_update.h"
#include "map/map.h"
#include "track/patch_store.h"

namespace pf {

/// Compares patches with each other where nothing else supports the pose. The first patch to update the filter would have the motion's gate
/// only, which is many pixels wide: an outlier passes it, the gates then reject the inliers, and patches that begin in that frame get a
/// wrong reference camera.
class PatchConsensus {
 public:
  PatchConsensus(Filter& filter, const Map& map, PatchStore& store, PatchFinder& finder, PatchUpdate& update)
      : filter_(filter), map_(map), store_(store), finder_(finder), update_(update) {}

  void begin_frame() {
    found_ = 0;
    is_contested_ = false;
  }
  /// Finds patches before any of them updates the filter. Where most are not consistent with the first one, puts the largest set that is
  /// consistent with one of them before the others. order: entries of the store.
  void put_consistent_first(const Pyramid& image, int* order, int count);

  /// Whether the corners of an entry were found in this frame.
  bool has_found(int entry) const { return (found_ >> entry & 1u) != 0; }
  /// Whether nothing supports the pose of this frame but patches of which no two are consistent.
  bool is_contested() const { return is_contested_; }

 private:
  /// Patches that were found before any updates the filter.
  struct Witnesses {
    static constexpr int kMax = 8;
    int count = 0;
    int entry[kMax];
    Body near[kMax];  ///< the pose that the prior and this patch's corners make most likely
  };
  /// The first one gives where the others are searched for.
  Witnesses find_witnesses(const Pyramid& image, const int* order, int count);
  /// Finds one patch in the image. is_first: it is searched for in all of its gate.
  bool find(const Pyramid& image, int wall, bool is_first, StoredPatch* patch);
  /// Whether b passes the gate given a, and a that of the prior:
  ///
  ///   r_b|a = r_b - S_ba S_aa^-1 r_a,   S_b|a = S_bb - S_ba S_aa^-1 S_ab
  bool are_consistent(const StoredPatch& a, const StoredPatch& b, const Body& near);
  /// The largest set (a bit for each witness) that is consistent with one of them, and its size. Ends with the first one that has most.
  unsigned largest_set(const Witnesses& found, int* size);

  Filter& filter_;
  const Map& map_;
  PatchStore& store_;
  PatchFinder& finder_;
  PatchUpdate& update_;
  PatchMeasurement of_another_;  ///< scratch: a patch with which another one is compared
  std::uint32_t found_ = 0;      ///< a bit for each entry
  bool is_contested_ = false;
};
static_assert(kMaxPatches <= 32, "a bit for each entry");

}  // namespace pf
