#pragma once

#include "sim/scene.h"
#include "sim/trajectory.h"

namespace pf::sim {

/// One side of a street (y down): fronts side by side in the plane z = kStreetFar, with pillars, shop signs and parked boxes before
/// them. The camera begins at the origin and walks along x.
inline constexpr int kStreetFronts = 7;
inline constexpr double kStreetFront = 12.0;    ///< width of a front [m]
inline constexpr double kStreetHigh = 6.0;      ///< height of a front [m]
inline constexpr double kStreetFar = 5.0;       ///< of the fronts from the way [m]
inline constexpr double kStreetEye = 1.6;       ///< of the camera above the ground [m]
inline constexpr double kStreetLength = 72.0;   ///< of the way [m]
inline constexpr double kStreetSeconds = 60.0;  ///< of the way

/// Middle of a front.
Vec3 street_front(int k);
/// Axes of all fronts: x along the street, y up, z out of the wall.
Mat3 street_axes();

Scene make_street(Random& random, const SceneOptions& options);
/// A second at rest, two until it has its speed, then on to the end.
Trajectory street_walk();

}  // namespace pf::sim
