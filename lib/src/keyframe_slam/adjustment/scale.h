#pragma once

#include "slam/window_motion.h"
#include "slam/window_planes.h"

namespace pf {

/// Multiplies all lengths of the window by s about a place that stays: keyframes, points, planes, and the body.
///
///   p -> c + s (p - c),   rho -> rho / s,   var(rho) -> var(rho) / s²,   (a, b, h) -> (a, b, s h)
void scale_window(Scalar s, const Vec3& c_W, WindowMap* map, WindowPlanes* planes, WindowMotion* motion);

}  // namespace pf
