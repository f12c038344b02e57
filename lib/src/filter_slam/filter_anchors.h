#pragma once

#include "base/status.h"
#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "map/map.h"

/// Anchors of the filter: each is held by a reference camera of the state, the copy of the camera from which it was set, and so moves with
/// every correction of that camera from then on.

namespace pf {

class FilterAnchors {
 public:
  FilterAnchors(Filter& filter, Map& map, FeatureKeeper& features) : filter_(filter), map_(map), features_(features) {}

  /// Sets an anchor from the camera of the frame at t_ns. Room is made by evicting features that were not seen since not_since_ns. kFull:
  /// there is no room. kRange: the plane is not where the anchor should be. Nothing has changed then.
  Status add(const AnchorRequest& asked, std::uint32_t map_id, std::int64_t t_ns, std::int64_t not_since_ns,
             std::uint32_t* id);
  void remove(int entry);
  /// Where the anchors of a map are by the state as it is now. One whose camera is no longer sound stays where it was. After the filter has
  /// begun again in the same map the camera of the last frame holds them, for which room is made as in add().
  void follow(std::uint32_t map_id, std::int64_t not_since_ns);

 private:
  int copy_camera(std::int64_t not_since_ns);
  int camera_of(std::int64_t t_ns, std::uint32_t map_id) const;
  void give_awaited(std::uint32_t map_id, std::int64_t not_since_ns);
  void leave(int entry);
  void place(Anchor* anchor) const;

  Filter& filter_;
  Map& map_;
  FeatureKeeper& features_;
};

}  // namespace pf
