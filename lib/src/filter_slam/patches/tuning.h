#pragma once

#include "base/scalar.h"

/// Tuned numbers of patches on walls, each with its meaning and unit. tools/sweep-tuning halves and doubles them;
/// what no sweep has measured has no figure here.

namespace pf::tuning {

/// Patches on walls: finding them again.
namespace patch_keeper {
inline constexpr Scalar kMinCosine = Scalar(0.407);    ///< of the slant at which a patch is looked for: 66 degrees
inline constexpr Scalar kCornersGate = Scalar(26.12);  ///< chi-square of eight degrees of freedom, 0.999
inline constexpr Scalar kCornerSigma = Scalar(0.05);   ///< [px] of a corner, beside the noise: warp and interpolation
inline constexpr float kWarpSlack = 0.1f;              ///< [px] of pixels, as far as it excuses residuals
inline constexpr int kSettledFrames = 5;               ///< of a patch, before its residuals estimate the noise
inline constexpr Scalar kAlignerReach = Scalar(12);    ///< [px] of the gate, beyond which a patch is searched for first
inline constexpr Scalar kLinearReach = Scalar(4);      ///< [px] of an innovation that is taken in as it is
inline constexpr Scalar kPoseSigma = Scalar(1);        ///< [px] of what is not the pose, where the pose is sought
inline constexpr int kPoseSteps = 6;                   ///< of that search
inline constexpr int kMaxFailures = 30;                ///< in a row, before a patch is dropped
inline constexpr int kMaxEarlyFailures = 3;            ///< the same of one that waits for its plane
inline constexpr int kMaxRejections = 4;               ///< in a row
inline constexpr int kUpheldFrames = 30;               ///< that a patch was measured, for its wall to be upheld by it
}  // namespace patch_keeper

/// Patches on walls: new ones.
namespace patch_selection {
inline constexpr Scalar kMinBirthCosine = Scalar(0.616);  ///< of the slant at birth: 52 degrees
inline constexpr Scalar kLastingCosine = Scalar(0.515);   ///< of the slant of a patch that will last: 59 degrees
inline constexpr Scalar kMargin = Scalar(0.1);  ///< around a patch that must be on the wall too, of half its side
inline constexpr Scalar kApart = Scalar(0.6);   ///< of the middles of two patches, in sides
inline constexpr int kOnWall = 3;               ///< patches of a wall in view
inline constexpr int kBetween = 15;             ///< frames from one that begins on a wall to the next
inline constexpr int kRetryFrames = 5;          ///< the same where the wall has none in view, or had no place
inline constexpr int kSizes = 4;                ///< parts of the side: a patch has all, or
inline constexpr int kSmallest = 1;             ///< fewer, but more than this
inline constexpr int kMinSide = 32;             ///< [px]
inline constexpr Scalar kObstacleGate = Scalar(6.63);  ///< chi-square, 0.99: above it a point is not on the wall
inline constexpr int kStaySteps = 4;                   ///< times at which a place is tested to be still in view
inline constexpr Scalar kStayStep = Scalar(0.25);      ///< [s] between them
inline constexpr int kCoarseSide = 52;                 ///< [px] from which texture is judged on level 2
}  // namespace patch_selection

/// Which plane a patch lies on.
namespace patch_waiting {
inline constexpr Scalar kMinParallax = 12;          ///< [px] of the corners: a tenth more depth moves them by one
inline constexpr Scalar kReach = Scalar(0.5);       ///< beyond a found plane's outline, in square roots of its area
inline constexpr Scalar kMostWidth = Scalar(1.06);  ///< ratio of distances of points that lie on one wall
inline constexpr Scalar kFromMost = Scalar(1.05);   ///< the same of a patch to theirs
inline constexpr int kMinMost = 8;                  ///< such points, which show where the wall is
inline constexpr int kYoungEvery = 2;               ///< frame that counts before the first depths are sure
inline constexpr int kFoundEvery = 20;              ///< frames, in the middle of which a patch may found a plane
inline constexpr int kMinVoting = 2;                ///< one in so many points before a wall agrees on where they are
}  // namespace patch_waiting

/// A patch on a wall that is far from its plan.
namespace patch_bend {
inline constexpr Scalar kMinParallax = Scalar(1);  ///< [px] from which an innovation may be the plane's fault
inline constexpr Scalar kMinShare = Scalar(0.5);   ///< of R, below which the rest of the linearisation does not matter
inline constexpr int kMaxRounds = 3;               ///< in which it is mended
}  // namespace patch_bend

/// A plane that a patch founds.
namespace patch_founding {
inline constexpr Scalar kFoundingParallax = 40;      ///< [px] of the corners: errors of a lens are a few percent of it
inline constexpr int kMaxFrames = 110;               ///< without a plane, after which a patch is dropped
inline constexpr Scalar kPriorSlope = Scalar(0.5);   ///< sigma of its slopes before the patch is taken in
inline constexpr Scalar kPriorRange = Scalar(0.3);   ///< the same of its distance, of its range
inline constexpr Scalar kMinLearnt = Scalar(0.25);   ///< of these sigmas that may be left behind it
inline constexpr Scalar kMaxChange = Scalar(0.1);    ///< of n / d since it was noted
inline constexpr Scalar kWidening = 100;             ///< times its covariance that the prior gets when it is taken back
inline constexpr Scalar kMinCosine = Scalar(0.407);  ///< of the slant: 66 degrees
}  // namespace patch_founding

}  // namespace pf::tuning
