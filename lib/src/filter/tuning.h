#pragma once

#include "base/scalar.h"

/// Tuned numbers of the filter: what each one means and its unit. tools/sweep-tuning halves and doubles them; what no
/// sweep has measured has no figure here.

namespace pf::tuning {

/// Pixels and their time.
namespace pixel {
inline constexpr Scalar kMinRowRate = Scalar(0.1);  ///< least factor by which motion along the readout slows the rows
}  // namespace pixel

/// Inverse depths.
namespace inverse_depth {
inline constexpr Scalar kMinRho = Scalar(1e-6);       ///< [1/m] below which a point has no place
inline constexpr Scalar kMinShownRho = Scalar(1e-3);  ///< [1/m] what is farther, or not positive, is shown here
inline constexpr Scalar kNever = Scalar(1e6);         ///< linearity index of a depth that is not well above zero
}  // namespace inverse_depth

/// Point groups.
namespace point_group {
inline constexpr Scalar kMinSpread = Scalar(0.01);  ///< of the points of a group: determinant by squared trace
inline constexpr Scalar kOwnNoise = Scalar(1e-10);  ///< relative variance of its own, which keeps P positive definite
}  // namespace point_group

/// The row that picks the log scale.
namespace scale {
inline constexpr int kMaxTried = 12;  ///< log lengths, the best known of which is taken
}  // namespace scale

/// Inertial samples.
namespace imu {
inline constexpr Scalar kSaturation = Scalar(0.995);  ///< of the range: a sample that reaches it says "at least this"
inline constexpr Scalar kMaxGap = Scalar(1.5);        ///< median intervals, above which samples are missing
inline constexpr Scalar kMaxHold = Scalar(1.5);  ///< median intervals behind the last sample, before the body coasts
inline constexpr Scalar kMaxCoast = Scalar(2);   ///< [s] without samples that a prediction covers
inline constexpr Scalar kBridge = Scalar(12);    ///< of a bridge: the integral of a random walk's, dt^3/12
inline constexpr int kAdaptSteps = 16;  ///< the median interval moves by this fraction of itself towards each new one
}  // namespace imu

}  // namespace pf::tuning
