#pragma once

#include "base/scalar.h"

/// Tuned numbers of the filter, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// Pixels and their time.
namespace pixel {
inline constexpr Scalar kMinRowRate = Scalar(0.1);  ///< least factor by which motion along the readout slows the rows
}  // namespace pixel

/// Point groups.
namespace point_group {
inline constexpr Scalar kMinSpread = Scalar(0.01);  ///< of the points of a group: determinant by squared trace
inline constexpr Scalar kOwnNoise = Scalar(1e-10);  ///< relative variance of its own, which keeps P positive definite
}  // namespace point_group

/// A plane, or a point of one, that is somewhere else.
namespace plane_slide {
inline constexpr Scalar kMinSlant = Scalar(0.02);  ///< sine between plane and ray, at least, for a place of the point
inline constexpr Scalar kLateral = Scalar(1e-5);   ///< [m] a point that moves along its ray is unsure across it
}  // namespace plane_slide

/// The row that picks the log scale.
namespace scale {
inline constexpr int kMaxTried = 12;  ///< log lengths, the best known of which is taken
}  // namespace scale

/// What is kept apart from P (lib/docs/theory/float.md). Smallest eigenvalue of correlations, 6 walks of 1,500 and 5,000 frames.
namespace apart {
inline constexpr Scalar kMaxScaleVariance = Scalar(4e-4);     ///< of the log scale in P; beyond it the scale leaves P
inline constexpr Scalar kLeftScaleVariance = Scalar(2.5e-6);  ///< that stays in P. With 0 -2e-4, with 1e-4 -2e-5
inline constexpr Scalar kGrowth = Scalar(6e-9);  ///< of a variance in float, by update and root of rows; 2e-9: -1e-5
inline constexpr int kSpeedTells = 30;  ///< updates after which the speed of a start no longer constrains the scale
inline constexpr Scalar kMinPoseSigma = Scalar(1e-3);  ///< [rad, m] of a given pose, below which it stays in P
inline constexpr Scalar kLeftSigma = Scalar(1e-5);     ///< [rad, m] of a given pose, that stays in P in any case
}  // namespace apart

/// Whether P is a covariance.
namespace soundness {
inline constexpr Scalar kRounding = Scalar(1e-6);       ///< that an eigenvalue of correlations may be below 0
inline constexpr Scalar kRoundingFloat = Scalar(5e-5);  ///< the same in float
inline constexpr Scalar kDigits = Scalar(4);            ///< last digits of a variance that an update's rounding hides
inline constexpr int kSample = 48;                      ///< rows of P that are checked in a frame
inline constexpr Scalar kStep = Scalar(4);              ///< factor by which a repair grows until it is enough
inline constexpr Scalar kMaxRepair = Scalar(64);  ///< of a variance; more than the rows of a sample is never needed
}  // namespace soundness

/// Scale and gravity from a moving camera.
namespace moving_start {
inline constexpr int kMinPoses = 8;             ///< that are solved
inline constexpr int kSteps = 6;                ///< of the refinement
inline constexpr Scalar kMaxStep = Scalar(20);  ///< of the log scale in one of them
}  // namespace moving_start

/// Inertial samples.
namespace imu {
inline constexpr Scalar kSaturation = Scalar(0.995);  ///< of the range: a sample that reaches it is only a lower bound
inline constexpr Scalar kMaxGap = Scalar(1.5);        ///< median intervals, above which samples are missing
inline constexpr Scalar kMaxHold = Scalar(1.5);  ///< median intervals behind the last sample, before the body coasts
inline constexpr Scalar kMaxCoast = Scalar(2);   ///< [s] without samples that a prediction covers
inline constexpr Scalar kBridge = Scalar(12);    ///< of a bridge: the integral of a random walk's, dt^3/12
inline constexpr int kAdaptSteps = 16;  ///< the median interval moves by this fraction of itself towards each new one
}  // namespace imu

/// Forgetting that a plane is vertical.
namespace vertical {
inline constexpr Scalar kMaxShrink = Scalar(1.05);  ///< of a variance, by rounding and by linearisation since
}  // namespace vertical

}  // namespace pf::tuning
