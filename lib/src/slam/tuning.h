#pragma once

#include "base/scalar.h"

/// Tuned numbers of the tracking states: what each one means and its unit. tools/sweep-tuning halves and doubles them; what no
/// sweep has measured has no figure here.

namespace pf::tuning {

/// What chance finds in wrong places of real images, measured in 48,000 searches (lib/docs/states.md).
namespace chance {
inline constexpr Scalar kMaxFindShare = Scalar(0.25);  ///< of searches that find something; found: 0.04 .. 0.24
inline constexpr Scalar kMinArea = Scalar(250);        ///< [px^2] per find in small ellipses, times kMaxFindShare
}  // namespace chance

/// A frame while tracking.
namespace tracking {
inline constexpr int kMinInliers = 8;       ///< of a tracked frame, or half of map.features_in_view if that is less
inline constexpr int kMinInliersOfFew = 5;  ///< and never fewer than that
inline constexpr Scalar kMaxLogFalse = Scalar(-6.9);  ///< ln 0.001 consensuses as good that chance gives per frame
inline constexpr int kTriples = 8;                    ///< of inliers, with which that number is computed
inline constexpr Scalar kMaxYoungGap = Scalar(0.2);   ///< [s] untracked, after which a young map is no longer followed
}  // namespace tracking

/// Whether a pose can be used.
namespace usable_pose {
inline constexpr Scalar kMaxRotationSigma = Scalar(0.349);  ///< [rad] 20 degrees
inline constexpr Scalar kMaxPositionSigma = Scalar(0.5);    ///< in median depths
}  // namespace usable_pose

/// Finding the map again.
namespace relocaliser {
inline constexpr Scalar kMaxLogFalse = Scalar(-13.8);  ///< ln 1e-6 consensuses as good that chance gives per frame
inline constexpr int kTriples = 40;                    ///< of inliers, with which that number is computed
inline constexpr int kFramesNearby = 2;    ///< in a row with a consensus about the prediction, after a short gap
inline constexpr int kFramesAnywhere = 3;  ///< in a row that agree; in random order one in 20 shows a neighbour
inline constexpr Scalar kNearbySigma = Scalar(0.1);  ///< [rad] rotation sigma of a prediction that is searched linearly
inline constexpr Scalar kMaxDepthSigma = Scalar(0.3);  ///< relative sigma of an inverse depth that may place the camera
inline constexpr Scalar kProposalPixels = Scalar(0.004);  ///< sigma of a match against the map, in image widths
inline constexpr float kMinRecognition = 0.5f;            ///< correlation of a kept view that is searched about
inline constexpr Scalar kAboutView = Scalar(0.1);         ///< sigma of the pose about a kept view [rad], and in depths
inline constexpr Scalar kAboutProposal = Scalar(0.03);    ///< likewise about the last frame's proposal
inline constexpr Scalar kMapSigma = Scalar(2);            ///< [px] of a point of the map in a search about such a pose
inline constexpr int kColumns = 4;                        ///< cells of the image
inline constexpr int kRows = 3;                           ///< cells of the image
inline constexpr int kMinCells = 4;                       ///< that hold inliers
inline constexpr Scalar kProposalRotation = Scalar(0.035);  ///< [rad] of proposals apart, on top of the motion
inline constexpr Scalar kProposalShift = Scalar(0.05);      ///< likewise, in depths
inline constexpr Scalar kMotionGate = Scalar(3);            ///< sigmas of the velocities
inline constexpr Scalar kMaxRateSigma = Scalar(1);          ///< [rad/s] of a hand
inline constexpr Scalar kMaxSpeedSigma = Scalar(0.5);       ///< [depths/s] of a hand
}  // namespace relocaliser

}  // namespace pf::tuning
