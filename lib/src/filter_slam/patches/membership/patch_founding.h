#pragma once

#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/patches/patch_update.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "map/map.h"
#include "track/patch_store.h"

namespace pf {

/// Founds planes by patches that no plane of the map explains (lib/docs/theory/walls.md).
class PatchFounding {
 public:
  PatchFounding(const Settings& settings, Filter& filter, Map& map, const Frame& frame, FeatureKeeper& features,
                PatchUpdate& update)
      : settings_(settings), filter_(filter), map_(map), frame_(frame), features_(features), update_(update) {}

  /// Notes the plane that two views give. They do not tell a plane that stands still from what moves or is no plane: the plane must be the
  /// same some frames later.
  void note_plane(StoredPatch* patch) const;
  /// Founds a plane where there is enough parallax, 10 frames after the plane was noted; waits for that, but not for ever. False: the
  /// patch lies on nothing.
  bool found_or_wait(StoredPatch* patch);

 private:
  /// Adds a plane with a wide prior and updates it with this frame's corners. Then the prior is taken back, so that what remains of the
  /// plane is what the patch says with all that this depends on. False where that is too little, or no plane explains the corners.
  bool found_plane(StoredPatch* patch);
  /// Whether its two views give the plane that was noted, and the map has room for it.
  bool may_found(const StoredPatch& patch, PlaneFit* fit, Scalar* range);
  /// Whether the corners tell enough of a plane that has this prior, on which nothing else depends: P_left = P - P H^T S^-1 H P over its
  /// three rows. Asked before they update it, since a prior that nothing takes back says where the world is.
  bool would_tell(const StoredPatch& patch, int entry, const Mat3& prior);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  const Frame& frame_;
  FeatureKeeper& features_;
  PatchUpdate& update_;
};

}  // namespace pf
