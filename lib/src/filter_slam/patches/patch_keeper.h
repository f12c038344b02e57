#pragma once

#include <cstdint>

#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/patches/initialisation/patch_initialiser.h"
#include "filter_slam/patches/initialisation/patch_selection.h"
#include "filter_slam/patches/membership/patch_founding.h"
#include "filter_slam/patches/membership/patch_membership.h"
#include "filter_slam/patches/patch_consensus.h"
#include "filter_slam/patches/patch_finder.h"
#include "filter_slam/patches/patch_noise.h"
#include "filter_slam/patches/patch_refusals.h"
#include "filter_slam/patches/patch_update.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "frame/tracking_state.h"
#include "map/map.h"
#include "track/patch_store.h"

namespace pf {

class Archive;

/// Keeps the patches of walls: the order of work of one frame. Measures those that lie on a wall, follows those that wait for their plane
/// (PatchMembership), drops those that fail, and has new ones initialised (PatchSelection).
/// Servant 2008, sections 2.3 and 2.4 (lib/docs/theory/homography.md).
class PatchKeeper {
 public:
  PatchKeeper(const Settings& settings, Filter& filter, Map& map, Frame& frame, FeatureKeeper& features,
              TrackingState& tracking);
  PatchKeeper(const PatchKeeper&) = delete;  // its parts refer to each other
  PatchKeeper& operator=(const PatchKeeper&) = delete;

  bool layout(Arena& arena);
  void init();

  /// Finds the patches in the image, and updates the filter with each that passes its gate. is_young: the map's depths are still uncertain,
  /// and a patch without parallax waits twice as long.
  void measure(const Pyramid& image, bool is_young);
  /// Drops patches that fail; supported: the frame's measurements support its pose. Begins new ones where it may.
  void maintain(const Pyramid& image, bool supported, bool may_begin);

  const PatchStore& patches() const { return store_; }
  /// Depths of the inliers' middles. Returns how many.
  int inlier_depths(Scalar* depth) const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  /// Drops all patches where the filter began anew, since their blocks are gone.
  void follow_filter();
  /// The patches most often measured first, since their updates make the others easier to find. Returns how many.
  int list_in_order(int* order) const;
  void measure_patch(const Pyramid& image, int i);
  /// Finds a patch at its prediction and sets its measurement. hiding: from hiding_wall. *is_through: that wall does not explain the patch.
  bool find(const Pyramid& image, int i, int wall, int hiding, PatchSight* sight, bool* is_through);
  /// Updates the noise with the residuals of inliers after the update.
  void learn_noise();
  void drop_failing(bool supported);
  /// Counts this frame's result for the patch. Returns whether it has failed too often.
  bool count_failures(StoredPatch* patch, int wall);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  PatchStore store_;
  PatchNoise noise_;
  PatchFinder finder_;
  PatchUpdate update_;
  PatchConsensus consensus_;
  PatchRefusals refusals_;
  PatchFounding founding_;
  PatchMembership membership_;
  PatchInitialiser initialiser_;
  PatchSelection selection_;
  std::uint32_t generation_ = 0;  ///< of the filter that the patches have blocks in
};

}  // namespace pf
