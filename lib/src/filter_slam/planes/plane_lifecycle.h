#pragma once

#include "filter/filter.h"
#include "filter_slam/features/feature_keeper.h"
#include "frame/settings.h"
#include "map/map.h"

/// Whole planes: change the frame, dissolve. Gee 2007, section 3.3.

namespace pf {

/// Gives a plane that has rotated away from its frame a new frame, parallel to the plane. A wall keeps the one that its prior is about.
void settle_frame(Filter& filter, Map& map, int plane_entry);

/// Unfolds all points of a plane, sigma_normal [m] more uncertain along its normal, and removes it.
void dissolve_plane(Filter& filter, Map& map, FeatureKeeper& features, Scalar sigma_normal, int plane_entry);

/// Dissolves a plane that has too few points for kMaxWeakFrames, and a new one that never gets more than plane_min_points. Dissolves
/// at once a plane with more outliers so far than points. Walls stay.
void dissolve_weak(const Settings& settings, Filter& filter, Map& map, FeatureKeeper& features);

}  // namespace pf
