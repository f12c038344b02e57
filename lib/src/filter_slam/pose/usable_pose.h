#pragma once

#include "filter/filter.h"
#include "frame/frame.h"
#include "map/map.h"

/// Whether a measured pose is known well enough to be used. See lib/docs/theory/states.md.

namespace pf {

/// Variances of a pose, summed over the three axes.
struct PoseSpread {
  Scalar rotation = 0;  ///< [rad^2]
  Scalar position = 0;  ///< [m^2]
};

/// Variances of the pose against the best known of these points, without the part that moves all of them and the camera together
/// (translation, rotation, scale). False with fewer than three points.
bool spread_against_points(const Filter& filter, const int* slots, int count, PoseSpread* spread);

/// True if rotation sigma is below 20 degrees and position sigma below half the median depth of this frame's inliers: in the world; or
/// where the world has drifted, as that of a bare camera does, against those inliers. False without inliers.
/// patch_depth   of the patches among the inliers, which are no matches
/// median_depth  gets that of all inliers
bool is_pose_usable(const Filter& filter, const Map& map, const Frame& frame, const Scalar* patch_depth, int patches,
                    Scalar* median_depth);

}  // namespace pf
