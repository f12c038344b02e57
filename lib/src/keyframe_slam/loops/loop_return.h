#pragma once

#include "keyframe_slam/loops/drift_chain.h"
#include "keyframe_slam/planes/planes.h"

/// Moves the parts of the map when its camera is back at a place (lib/docs/theory/places.md).

namespace pf {

class LoopReturn {
 public:
  LoopReturn(const Settings& settings, KeyframeMap& map, KeyframePlanes& planes)
      : settings_(settings), map_(map), planes_(planes) {}

  bool layout(Arena& arena);

  /// Keyframes that are connected with the newest one, and were made since the camera was at the place, move with it, by x: what they
  /// share says better than the chain how they lie to each other. Other keyframes and places move by their share of x, and planes with
  /// the points that lie on them. Places that have come back before stay. covariance: of the camera's (theta, p) in W then. seen: room
  /// for a mark on each point of the window. False: nothing has moved.
  bool close(const LoopClosure& loop, bool* seen, DriftChain* chain, Mat6* covariance);
  /// How close() has moved what is nearest to a view.
  Similarity near(const Quat& q_WC, const Vec3& p_W, Scalar depth) const;

 private:
  /// A place, or a keyframe.
  struct Part {
    Quat q_WK;
    Vec3 p_WK;  ///< before
    Similarity T;
  };

  void choose_whole(int place, bool* seen);
  bool is_plane_of_whole(int plane) const;

  const Settings& settings_;
  KeyframeMap& map_;
  KeyframePlanes& planes_;
  bool* is_whole_ = nullptr;  ///< of each keyframe: whether it moves with the newest one
  Part* part_ = nullptr;
  int parts_ = 0;
};

}  // namespace pf
