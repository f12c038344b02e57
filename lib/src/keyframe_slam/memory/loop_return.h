#pragma once

#include "keyframe_slam/planes/planes.h"
#include "keyframe_slam/tracking/loop_finder.h"

/// Moves the parts of the map when its camera is back at a place (lib/docs/theory/places.md).

namespace pf {

class LoopReturn {
 public:
  LoopReturn(KeyframeMap& map, KeyframePlanes& planes) : map_(map), planes_(planes) {}

  bool layout(Arena& arena, const Settings& settings);

  /// Moves the newest keyframe by x, what was made since the camera was at that place by its share of x, and leaves what is older:
  ///
  ///   x_i = C_i C⁻¹ x,   C_i+ = C_i - C_i C⁻¹ (C - C+) C⁻¹ C_i       C_i, C: drift of the part, and of the newest keyframe, since the place
  ///
  /// covariance: of the camera's (theta, p) in W then. False: nothing has moved.
  bool close(const LoopClosure& loop, DriftChain* chain, Mat6* covariance);
  /// How close() has moved what is nearest to a view.
  Similarity near(const Quat& q_WC, const Vec3& p_W, Scalar depth) const;

 private:
  /// A place, or a keyframe.
  struct Part {
    Quat q_WK;
    Vec3 p_WK;  ///< before
    Similarity T;
  };

  bool is_in_view(int plane, int left_at) const;

  KeyframeMap& map_;
  KeyframePlanes& planes_;
  Part* part_ = nullptr;
  int parts_ = 0;
};

}  // namespace pf
