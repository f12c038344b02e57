#pragma once

#include "base/scalar.h"

/// Tuned numbers of the filter back end's start, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// First depths against those of a record, where walls are known.
namespace start_before_walls {
inline constexpr int kCells = 9;         ///< of the first image, a side, whose middles are looked at for walls
inline constexpr Scalar kOpenScale = 1;  ///< sigma of the log scale until a wall is seen
inline constexpr Scalar kSameMotion = Scalar(0.5);  ///< of two motions: their difference relative to the record's
}  // namespace start_before_walls

}  // namespace pf::tuning
