#ifndef PLANEFOLD_CAPTURE_PLANE_OUTPUTS_H
#define PLANEFOLD_CAPTURE_PLANE_OUTPUTS_H

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "view.h"

namespace pf::capture {

/// map.ply: points with their uncertainties, then the corners of the planes' outlines, and the outlines as coloured faces.
/// sigmas_in_map  one for each feature, or empty: the file then has no such property
std::string to_ply(const std::vector<pf_feature_t>& features, const std::vector<double>& sigmas_in_map,
                   const std::vector<PlaneView>& planes);

/// [{id, normal, distance, sigma, points, area_m2, outline}] of report.json, and what is useful beside it.
nlohmann::ordered_json planes_json(const std::vector<PlaneView>& planes);

}  // namespace pf::capture

#endif
