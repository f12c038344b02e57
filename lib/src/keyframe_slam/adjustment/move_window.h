#pragma once

#include "geometry/similarity.h"
#include "keyframe_slam/planes/planes.h"
#include "keyframe_slam/tracking/motion.h"

namespace pf {

/// Moves a keyframe within W, and the points that it hosts:
///
///   p -> s R p + t,   R_WC -> R R_WC,   rho -> rho / s,   var(rho) -> var(rho) / s²
void move_keyframe(const Similarity& T, int keyframe, KeyframeMap* map);
/// Moves all of the window: keyframes, points, places, planes, and the body. Of planes (a, b, h) -> (a, b, s h).
void move_window(const Similarity& T, KeyframeMap* map, KeyframePlanes* planes, KeyframeMotion* motion);

}  // namespace pf
