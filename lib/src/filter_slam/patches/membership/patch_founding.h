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

  /// Notes the plane that two views give. Two views do not exclude a moving plane or another surface, so the plane must be the same some
  /// frames later.
  void note_plane(StoredPatch* patch) const;
  /// Founds a plane where there is enough parallax, 10 frames after the plane was noted; waits for that up to a bound. False: no plane
  /// explains the patch.
  bool found_or_wait(StoredPatch* patch);

 private:
  /// Adds a plane with a wide prior and updates it with this frame's corners. Then removes the prior, so that the plane's covariance is
  /// that of the patch and of all on which it depends. False where the patch constrains it too little, or no plane explains the corners.
  bool found_plane(StoredPatch* patch);
  /// Whether its two views give the plane that was noted, and the map has room for it.
  bool may_found(const StoredPatch& patch, PlaneFit* fit, Scalar* range);
  /// Whether the corners constrain a plane with this prior enough, on which nothing else depends: P_left = P - P H^T S^-1 H P over its
  /// three rows. Called before they update it, since a prior that is not removed would constrain the gauge.
  bool would_tell(const StoredPatch& patch, int entry, const Mat3& prior);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  const Frame& frame_;
  FeatureKeeper& features_;
  PatchUpdate& update_;
};

}  // namespace pf
