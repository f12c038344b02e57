#pragma once

#include "base/status.h"
#include "keyframe_slam/planes/planes.h"

/// Anchors of the window: each is held by the keyframe that was nearest when it was set, or by the place that this has become.

namespace pf {

class KeyframeAnchors {
 public:
  KeyframeAnchors(AnchorTable& anchors, const KeyframeMap& map, const KeyframePlanes& planes)
      : anchors_(anchors), map_(map), planes_(planes) {}

  /// Where an anchor is set from: the camera, what it may be off against the map, and what the map may be off.
  struct View {
    RelativePlace T_WV;
    Mat6 covariance = Mat6::Zero(), covariance_of_map = Mat6::Zero();
    Scalar depth = 1;  ///< of what it sees, median
    std::int64_t t_ns = 0;
  };
  /// kFull: there is no room. kRange: the plane is not where the anchor should be. Nothing has changed then.
  Status add(const AnchorRequest& asked, std::uint32_t map_id, const View& view, std::uint32_t* id);
  /// The map has begun again with other poses, of which the newest keyframe has this frame's: anchors stay where they are before it.
  void move(const RelativePlace& from_WC, const RelativePlace& to_WC, std::uint32_t map_id);
  /// Where the anchors of a map are by the map as it is now. One whose keyframe or place is gone is held by what is nearest to it. depth:
  /// of what is seen, median.
  void follow(std::uint32_t map_id, Scalar depth);

 private:
  /// What holds an anchor: a keyframe, a place, or W, which has the id 0.
  struct Reference {
    std::uint32_t id = 0;
    RelativePlace T_WK;
    Mat6 covariance = Mat6::Zero();
  };

  bool find(std::uint32_t id, Reference* out) const;
  Reference nearest(const RelativePlace& T_WV, Scalar depth) const;
  void place(Scalar depth, Anchor* anchor) const;

  AnchorTable& anchors_;
  const KeyframeMap& map_;
  const KeyframePlanes& planes_;
};

}  // namespace pf
