#pragma once

#include "keyframe_slam/planes/planes.h"
#include "keyframe_slam/tracking/motion.h"

namespace pf {

/// Multiplies all lengths of the window by s about a place that stays: keyframes, points, planes, and the body.
///
///   p -> c + s (p - c),   rho -> rho / s,   var(rho) -> var(rho) / s²,   (a, b, h) -> (a, b, s h)
void scale_window(Scalar s, const Vec3& c_W, KeyframeMap* map, KeyframePlanes* planes, KeyframeMotion* motion);

}  // namespace pf
