#pragma once

#include "geometry/similarity.h"
#include "keyframe_slam/planes/planes.h"
#include "keyframe_slam/tracking/motion.h"

namespace pf {

/// Moves all of the window: keyframes, points, places, planes, and the body.
///
///   p -> s R p + t,   R_WC -> R R_WC,   rho -> rho / s,   var(rho) -> var(rho) / s²,   (a, b, h) -> (a, b, s h)
/// Moves a keyframe within W, and the points that it hosts.
void move_keyframe(const Similarity& T, int keyframe, KeyframeMap* map);
void move_window(const Similarity& T, KeyframeMap* map, KeyframePlanes* planes, KeyframeMotion* motion);

}  // namespace pf
