#pragma once

#include "base/scalar.h"

/// Tuned numbers of walls and patches that are young. Patches that are measured: slam/tuning.h

namespace pf::tuning {

/// First depths against those of a record, where walls are known.
namespace start_before_walls {
inline constexpr int kMaxPlanes = 64;             ///< the largest capacity.max_planes
inline constexpr Scalar kOneWall = Scalar(1.12);  ///< ratio of distances of points that lie on walls of the plan
inline constexpr int kMinOnWall = 8;              ///< points that tell the record's unit of length
inline constexpr int kClearMajority = 2;          ///< of these to the points that tell another one
inline constexpr int kCells = 9;                  ///< of the first image, a side, whose middles are looked at for walls
inline constexpr int kMaxRatios = 256;            ///< that are compared
inline constexpr Scalar kOpenScale = 1;           ///< sigma of the log scale until a wall is seen
inline constexpr Scalar kSameMotion = Scalar(0.5);  ///< of two motions: their difference relative to the record's
}  // namespace start_before_walls

/// Which plane a patch lies on.
namespace patch_waiting {
inline constexpr Scalar kMinParallax = 12;          ///< [px] of the corners: a tenth more depth moves them by one
inline constexpr Scalar kReach = Scalar(0.5);       ///< beyond a found plane's outline, in square roots of its area
inline constexpr Scalar kMostWidth = Scalar(1.06);  ///< ratio of distances of points that lie on one wall
inline constexpr Scalar kFromMost = Scalar(1.05);   ///< likewise of a patch to theirs
inline constexpr int kMinMost = 8;                  ///< such points, that tell where the wall is
inline constexpr int kYoungEvery = 2;               ///< frame that counts before the first depths are sure
inline constexpr int kFoundEvery = 20;              ///< frames, in the middle of which a patch may found a plane
}  // namespace patch_waiting

/// A patch on a wall that is far from its plan.
namespace patch_bend {
inline constexpr Scalar kMinParallax = Scalar(1);  ///< [px] from which an innovation may be the plane's fault
inline constexpr Scalar kMinShare =
    Scalar(0.5);                      ///< of R, below which what the linearisation leaves out does not matter
inline constexpr int kMaxRounds = 3;  ///< in which it is mended
}  // namespace patch_bend

/// A plane that a patch founds.
namespace patch_founding {
inline constexpr Scalar kFoundingParallax = 40;      ///< [px] of the corners: errors of a lens are a few percent of it
inline constexpr int kMaxFrames = 110;               ///< without a plane, after which a patch is dropped
inline constexpr Scalar kPriorSlope = Scalar(0.5);   ///< sigma of its slopes before the patch is taken in
inline constexpr Scalar kPriorRange = Scalar(0.3);   ///< likewise of its distance, of its range
inline constexpr Scalar kMinLearnt = Scalar(0.25);   ///< of these sigmas that may be left behind it
inline constexpr Scalar kMaxChange = Scalar(0.1);    ///< of n / d since it was noted
inline constexpr Scalar kWidening = 100;             ///< times its covariance that the prior gets when it is taken back
inline constexpr Scalar kMinCosine = Scalar(0.407);  ///< of the slant: 66 degrees
}  // namespace patch_founding

}  // namespace pf::tuning
