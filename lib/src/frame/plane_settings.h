#pragma once

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

}  // namespace pf
