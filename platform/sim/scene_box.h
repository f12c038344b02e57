#pragma once

#include "sim/scene.h"
#include "sim/trajectory.h"

namespace pf::sim {

/// The box of Servant 2008, section 3: 1 m, its middle at the origin of W (y down), posters of 0.9 m on its four sides, on a floor. Side k
/// has the normal (sin a, 0, cos a), a = k 90 degrees.
inline constexpr int kBoxSides = 4;
inline constexpr double kBoxHalf = 0.5;      ///< [m]
inline constexpr double kBoxPoster = 0.45;   ///< half of a poster [m]
inline constexpr double kBoxRadius = 2.0;    ///< of the circle around it [m]
inline constexpr double kBoxSeconds = 30.0;  ///< once around

Vec3 box_normal(int side);
/// Axes of a side: x to the right, y up, z out of the box.
Mat3 box_axes(int side);

Scene make_box(Random& random, const SceneOptions& options);
/// Around the box, looking at its middle: a second at rest, two until it has its speed, then once around in so many seconds. It begins
/// at an angle of begin_rad from the normal of side 0.
Trajectory box_circle(double loop_seconds, double begin_rad);

}  // namespace pf::sim
