#pragma once

#include <algorithm>

#include "frame/settings.h"
#include "map/plane_search.h"

namespace pf {

/// How the config asks for planes to be found, for either back end.
inline PlaneSearchSettings plane_search_settings(const Settings& settings) {
  PlaneSearchSettings search;
  search.min_points = settings.plane_min_points;
  search.distance = settings.plane_distance;
  search.radius = settings.plane_radius;
  search.normal_variance = settings.plane_distance * settings.plane_distance / Scalar(4);
  return search;
}

/// The distance that a point so far from the camera may have from a plane. plane.max_distance is one at the depth of the start; what is
/// farther is known, and its surface told from others, in proportion to its depth.
inline Scalar distance_at(const Settings& settings, Scalar range) {
  return settings.plane_distance * std::max(Scalar(1), range / settings.start_depth);
}

}  // namespace pf
