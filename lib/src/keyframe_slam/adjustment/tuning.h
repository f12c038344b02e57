#pragma once

#include "base/scalar.h"

/// Tuned numbers of the adjustment of keyframes, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// The adjustment of keyframes.
namespace keyframe_adjustment {
inline constexpr int kMinPoints = 8;          ///< that an adjustment needs
inline constexpr int kMinShared = 8;          ///< points that a fixed keyframe shares with the free ones
inline constexpr int kRounds = 10;            ///< of Levenberg-Marquardt
inline constexpr int kFirstRounds = 30;       ///< the same, while the window holds all keyframes
inline constexpr int kMinPlanePoints = 4;     ///< of a plane that is adjusted
inline constexpr int kMinScaleKeyframes = 2;  ///< held fixed, so that distances from planes do not shrink the map
inline constexpr int kMinConnected = 3;   ///< keyframes that are adjusted without those that they share no points with
inline constexpr int kHeldKeyframes = 3;  ///< the oldest, where all others are adjusted
inline constexpr int kHeldAway = 6;       ///< the same, where the first keyframe of the map is not among them
inline constexpr Scalar kHeldDistance = Scalar(1e-3);   ///< of a distance that holds the scale: its sigma
inline constexpr int kMinTargetPoints = 4;              ///< of the target, that hold a keyframe
inline constexpr Scalar kHuber = Scalar(2);             ///< residuals beyond count linearly [standard deviations]
inline constexpr Scalar kMinSigma = Scalar(0.25);       ///< [px] of a pixel, at least
inline constexpr Scalar kOutlierSigmas = Scalar(5);     ///< of a pixel that is forgotten afterwards
inline constexpr Scalar kPriorSigma = Scalar(10);       ///< of the prior on inverse depths, in their mean
inline constexpr Scalar kBehindWeight = Scalar(1e4);    ///< of the prior in addition, where a point is behind its host
inline constexpr Scalar kNoPixelPenalty = Scalar(100);  ///< of a seen point that does not project [chi-square]
inline constexpr Scalar kTargetSigma = Scalar(1e-4);    ///< of the distance of a target's point, in distances, at least
inline constexpr int kMinPerHeld = 2;                   ///< keyframes that are connected, for each that is held
}  // namespace keyframe_adjustment

}  // namespace pf::tuning
