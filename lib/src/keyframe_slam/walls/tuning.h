#pragma once

#include "base/scalar.h"

/// Tuned numbers of walls in the keyframe back end, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// Points before a wall that the map has not measured.
namespace keyframe_walls {
inline constexpr Scalar kKnownBetter = 3;  ///< times as well as the wall, of a distance that places it
inline constexpr int kRounds = 3;          ///< in which the comparison with the plan is linearised anew
}  // namespace keyframe_walls

}  // namespace pf::tuning
