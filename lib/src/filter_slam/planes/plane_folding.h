#pragma once

#include "filter/filter.h"
#include "filter_slam/planes/certain_points.h"
#include "frame/settings.h"
#include "map/map.h"

/// Points of planes: unfold, fold, fix. Gee 2007, sections 3.3 and 3.4.

namespace pf {

/// Unfolds points that were matched kMaxRejections times in a row outside of their gate, and inflates their plane.
void unfold_outliers(const Settings& settings, Filter& filter, Map& map);

/// Folds points that lie on the plane.
void fold_into(const Settings& settings, Filter& filter, Map& map, const CertainPoints& certain, int plane_entry);

/// Fixes points that are known well relative to the other points of their plane.
void fix_on(const Settings& settings, Filter& filter, const Map& map, int plane_entry);

/// Standard deviation of (a, b, h) of a plane whose points were wrong by about plane_distance.
Vec3 wrong_points_sigma(const Settings& settings);

}  // namespace pf
