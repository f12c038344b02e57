#pragma once

#include "base/arena.h"
#include "base/status.h"
#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "filter_slam/filter_anchors.h"
#include "filter_slam/memory/filter_memory.h"
#include "filter_slam/patches/patch_keeper.h"
#include "filter_slam/planes/plane_keeper.h"
#include "filter_slam/pose_mark.h"
#include "frame/frame.h"
#include "frame/settings.h"
#include "frame/tracking_state.h"
#include "map/map.h"

/// Maintains what the map holds: features, planes, patches, anchors and the marked pose.

namespace pf {

class Archive;

class MapUpkeep {
 public:
  MapUpkeep(const Settings& settings, Filter& filter, Map& map, Frame& frame, TrackingState& tracking)
      : settings_(settings),
        filter_(filter),
        map_(map),
        frame_(frame),
        tracking_(tracking),
        features_(settings, filter, map, frame),
        planes_(settings, filter, map, frame, features_),
        mark_(filter, map, features_),
        anchors_(filter, map, features_) {}

  bool layout(Arena& arena);
  void init();

  /// After a frame is measured. supported: its measurements support its pose; else nothing is decided about the map.
  void maintain(bool supported, const StartProgress& start);
  /// The same for patches. New ones may begin where is_first, where the frame is tracked, or while the map is empty.
  void maintain_patches(const Pyramid& image, bool supported, const StartProgress& start, bool is_first);

  /// Repairs the covariance where it has to. False where the estimate is not finite, or P is no covariance and nothing helps.
  bool repair_estimate();

  /// The caller states that the plane with this id is vertical within sigma [rad] (VerticalTable::tell). kState: gravity is not known.
  /// kNothing: no such plane.
  Status set_plane_vertical(std::uint32_t id, Scalar sigma);

  /// After a frame: places follow the view of a tracked one, in a map whose depths are known. depth: median, of what is seen.
  void follow_places(bool is_starting, Scalar depth);
  /// The map is discarded, or its lengths have changed.
  void forget_places() {
    if (memory_ != nullptr) memory_->clear();
  }
  bool is_in_loaded_map() const { return memory_ != nullptr && memory_->is_loaded(); }
  /// Null where the config has no room for places.
  FilterMemory* memory() { return memory_; }
  const FilterMemory* memory() const { return memory_; }

  FeatureKeeper& features() { return features_; }
  PlaneKeeper& planes() { return planes_; }
  PoseMark& mark() { return mark_; }
  FilterAnchors& anchors() { return anchors_; }
  /// Null where the config has no room for patches.
  PatchKeeper* patches() { return patches_; }
  const PatchKeeper* patches() const { return patches_; }

  void carry(Archive& archive);  ///< base/archive.h

 private:
  bool layout_patches(Arena& arena);

  const Settings& settings_;
  Filter& filter_;
  Map& map_;
  Frame& frame_;
  TrackingState& tracking_;
  FeatureKeeper features_;
  PlaneKeeper planes_;
  PoseMark mark_;
  FilterAnchors anchors_;
  PartPointer<FilterMemory, kHasMemory> memory_;  ///< in the block, where the config has room for places
  PartPointer<PatchKeeper, kHasWalls> patches_;   ///< in the block, where the config has room for patches
};

}  // namespace pf
