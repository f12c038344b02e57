#pragma once

#include "base/scalar.h"

/// Tuned numbers of blocks, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// Inverse depths.
namespace inverse_depth {
inline constexpr Scalar kMinRho = Scalar(1e-6);       ///< [1/m] below which a point has no place
inline constexpr Scalar kMinShownRho = Scalar(1e-3);  ///< [1/m] farther or negative depths are shown at this one
inline constexpr Scalar kNever = Scalar(1e6);         ///< linearity index of a depth that is not well above zero
}  // namespace inverse_depth

}  // namespace pf::tuning
