#pragma once

#include "filter/filter.h"
#include "map/map.h"
#include "slam/frame.h"

/// Whether a measured pose is known well enough to be used.

namespace pf {

/// Rotation to 20 degrees and position to half the median depth: against the world; or, where that has drifted as the world of a bare camera
/// does, against the points that this frame has measured, without the scale that all share. median_depth gets that of the inliers. False also
/// where there are none.
bool is_pose_usable(const Filter& filter, const Map& map, const Frame& frame, Scalar* median_depth);

}  // namespace pf
