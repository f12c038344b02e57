#pragma once

#include "sim/trajectory.h"

namespace pf::sim {

/// The walks of the named scenes: each begins before the target at about 0.7 m, sees it obliquely, and looks around. The
/// seed moves the way points by a few centimetres.
Trajectory desk_path(Random& random);
Trajectory room_path(Random& random);
/// Ten metres along the corridor, looking ahead and to both sides.
Trajectory corridor_path(Random& random);
Trajectory wall_path(Random& random);
/// Sideways at a constant speed, 0.8 m before two planes in a checkerboard.
Trajectory checker_path(Random& random);
Trajectory clutter_path(Random& random);
/// To and fro before leaves, for more than 20 s.
Trajectory bushes_path(Random& random);

}  // namespace pf::sim
