#pragma once

#include "sim/scene.h"
#include "sim/trajectory.h"

namespace pf::sim {

/// One side of a road (y down): poles, parked boxes and signs before fronts at two depths. The target's board stands at the kerb in
/// the plane z = 0, and the camera passes along x in the plane z = -kRoadNear. After the third sequence of Masoud 2015, Table 1
inline constexpr double kRoadLength = 72.0;   ///< of the way [m]
inline constexpr double kRoadSeconds = 20.0;  ///< of the way
inline constexpr double kRoadNear = 4.0;      ///< of the way from the kerb [m]

Scene make_road(Random& random, const SceneOptions& options);
/// A second at rest before the target, two until it has its speed, then on to the end.
Trajectory road_path(Random& random);

}  // namespace pf::sim
