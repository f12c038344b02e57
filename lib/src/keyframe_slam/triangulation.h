#pragma once

#include "frame/frame.h"
#include "keyframe_slam/map/keyframe_map.h"
#include "keyframe_slam/tracking/motion.h"

namespace pf {

/// Rule by which points get depths.
struct TriangulationRule {
  Scalar sigma_px;  ///< of a pixel
  Scalar bound_px;  ///< within which a depth explains a pixel
  bool
      strict;  ///< points that no depth explains are dropped, and pixels are taken to the frame's time by the body's velocities
};

/// Gives this frame's inliers a depth where their rays from host and frame differ by enough.
void triangulate(const Frame& frame, const KeyframeMotion& motion, const TriangulationRule& rule, KeyframeMap* map);

}  // namespace pf
