#pragma once

#include "frame/start/start.h"

/// The surface that a target is on.

namespace pf {

/// Normal of the plane on which all points of a target lie, in W, of either sign. Zero where the points are no single plane's, or fewer
/// than four: three always have one, whether or not they are corners of it.
///
/// Corners are drawn in other views by the slant of their surface. Taken to face the first camera, a wall that is seen at 15 degrees
/// gives edges that are turned by a degree, and all four corners of a rectangle come out 0.05 px towards its middle.
Vec3 target_normal(const Target& target);

}  // namespace pf
