#pragma once

#include "base/scalar.h"

/// Tuned numbers of tracking in the keyframe back end, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// Prediction of the window's body.
namespace keyframe_motion {
inline constexpr Scalar kGrowth = Scalar(2e-6);  ///< of a variance in float, by prediction
}  // namespace keyframe_motion

/// Pose of a frame of the window.
namespace keyframe_pose {
inline constexpr int kSeed = 1;                       ///< of the generator that draws triples
inline constexpr int kTrials = 100;                   ///< triples, at most
inline constexpr int kRefinementRounds = 6;           ///< of the consensus
inline constexpr Scalar kBoundSigmas = Scalar(3);     ///< of a match that make the bound of an inlier
inline constexpr Scalar kHuber = Scalar(2);           ///< residuals beyond count linearly [standard deviations]
inline constexpr int kRounds = 5;                     ///< of Gauss-Newton with each match's own noise
inline constexpr Scalar kSmallStep2 = Scalar(1e-12);  ///< [rad^2, m^2] squared step that ends the fit
}  // namespace keyframe_pose

/// A frame of the window.
namespace keyframe_tracking {
inline constexpr Scalar kMapSigma = Scalar(1);           ///< [px] of a point of the map beside its depth, in a search
inline constexpr Scalar kBoundWidth = Scalar(0.004);     ///< of a match that supports a pose, in image widths
inline constexpr Scalar kBoundSigmas = Scalar(4);        ///< the same, in standard deviations of a match
inline constexpr int kScouts = 30;                       ///< candidates that are measured first in wide ellipses
inline constexpr Scalar kWideEllipse = Scalar(12);       ///< [px] largest semi-axis of those
inline constexpr Scalar kTemplateEllipse = Scalar(4.5);  ///< [px] largest semi-axis in which templates are tried
inline constexpr int kRowPasses = 2;                     ///< of consensus with the velocities that its pose implies
inline constexpr int kYoung = 16;                        ///< points with a depth, below which the others help
inline constexpr Scalar kOpenSpread = Scalar(2);         ///< of an inverse depth not known yet, in the median one
inline constexpr Scalar kWeakPrior = Scalar(1);          ///< weight of the prediction where matches leave a pose open
inline constexpr Scalar kMaxParallel = Scalar(0.0087);  ///< [rad] between rays that need no depth to fit: half a degree
}  // namespace keyframe_tracking

}  // namespace pf::tuning
