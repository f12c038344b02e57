#pragma once

#include "base/scalar.h"

/// Tuned numbers of finding the map again, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// Poses from triples of matches.
namespace pose_proposal {
inline constexpr int kTrials = 120;                   ///< triples
inline constexpr int kSteps = 6;                      ///< of Gauss-Newton
inline constexpr int kRefits = 3;                     ///< to all inliers
inline constexpr Scalar kMaxStep2 = Scalar(10);       ///< [rad^2] squared rotation of a step; a larger one has diverged
inline constexpr Scalar kSmallStep2 = Scalar(1e-10);  ///< [rad^2, m^2] squared step that ends the fit
}  // namespace pose_proposal

}  // namespace pf::tuning
