#pragma once

#include <algorithm>

#include "frame/settings.h"
#include "map/plane_search.h"

namespace pf {

/// Settings of the plane search from the config, for both back ends.
inline PlaneSearchSettings plane_search_settings(const Settings& settings) {
  PlaneSearchSettings search;
  search.min_points = settings.plane_min_points;
  search.distance = settings.plane_distance;
  search.radius = settings.plane_radius;
  search.normal_variance = settings.plane_distance * settings.plane_distance / Scalar(4);
  return search;
}

/// Largest distance from a plane of a point at this range from the camera. plane.max_distance is that at the depth of the start; for
/// farther points it grows in proportion, as the uncertainty of their depth does.
inline Scalar distance_at(const Settings& settings, Scalar range) {
  return settings.plane_distance * std::max(Scalar(1), range / settings.start_depth);
}

}  // namespace pf
