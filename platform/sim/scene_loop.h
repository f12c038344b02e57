#pragma once

#include "sim/scene.h"
#include "sim/trajectory.h"

namespace pf::sim {

/// A ring of corridors about a block (y down), and a walk once around and on along its beginning. The target is on the outer wall before
/// which the walk begins.
inline constexpr double kLoopSide = 9.0;      ///< of the outer walls [m]
inline constexpr double kLoopWidth = 2.0;     ///< of the corridors [m]
inline constexpr double kLoopStep = 0.5;      ///< of a way point [m]
inline constexpr double kLoopInterval = 0.5;  ///< the same [s]
inline constexpr int kLoopSteps = 64;         ///< of them
inline constexpr double kLoopLength = 25.4;   ///< of the way once around [m]
inline constexpr int kLoopFrames = 990;       ///< at 30 a second

Scene make_loop(Random& random, const SceneOptions& options);
Trajectory loop_path(Random& random);

}  // namespace pf::sim
