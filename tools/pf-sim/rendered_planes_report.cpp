#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "rendered_planes.h"
#include "statistics.h"

namespace pfsim {

using nlohmann::json;

namespace {

/// The plane of the map that is a surface; of several the one that covers most of it. Null when there is none.
const PlaneVerdict* plane_of(const PlanesVerdict& run, int surface) {
  const PlaneVerdict* best = nullptr;
  for (int k = 0; k < run.planes; ++k) {
    const PlaneVerdict& p = run.plane[k];
    if (p.surface == surface && (!best || p.covered > best->covered)) best = &p;
  }
  return best;
}

double number(float value) { return std::round(static_cast<double>(value) * 1e5) / 1e5; }

json run_json(const PlanesVerdict& run) {
  json planes = json::array(), surfaces = json::array();
  for (int k = 0; k < run.planes; ++k) {
    const PlaneVerdict& p = run.plane[k];
    json one = {{"id", p.id}, {"points", p.points}, {"area_m2", number(p.area_m2)}, {"surface", p.surface}};
    if (p.explained_by >= 0) one["explained_by"] = p.explained_by;
    if (p.surface >= 0) {
      one["normal_deg"] = number(p.normal_deg);
      one["offset_m"] = number(p.offset_m);
      one["nees"] = number(p.nees);
      one["covered"] = number(p.covered);
      one["overstep"] = number(p.overstep);
    }
    planes.push_back(one);
  }
  for (int k = 0; k < run.surfaces; ++k) {
    const SurfaceVerdict& s = run.surface[k];
    if (static_cast<double>(s.seen_m2) > kSeenArea)
      surfaces.push_back({{"surface", s.surface}, {"seen_m2", number(s.seen_m2)}, {"planes", s.planes}});
  }
  return {{"planes", planes}, {"wanted", surfaces}};
}

}  // namespace

json planes_json(const std::vector<const PlanesVerdict*>& runs) {
  int true_planes = 0, false_planes = 0, explained = 0, duplicates = 0, wanted = 0, found = 0, close = 0, outlined = 0;
  double worst_normal = 0, worst_offset = 0, least_covered = 1, most_overstep = 0;
  double nees_sum = 0;
  std::vector<double> nees;
  json each = json::array();
  for (const PlanesVerdict* run : runs) {
    for (int k = 0; k < run->planes; ++k) {
      const PlaneVerdict& p = run->plane[k];
      (p.surface >= 0 ? true_planes : false_planes) += 1;
      explained += p.explained_by >= 0;
      if (p.surface < 0 || p.nees < 0) continue;
      nees.push_back(static_cast<double>(p.nees));
      nees_sum += nees.back();
    }
    for (int k = 0; k < run->surfaces; ++k) {
      const SurfaceVerdict& s = run->surface[k];
      duplicates += std::max(0, s.planes - 1);
      if (!(static_cast<double>(s.seen_m2) > kSeenArea)) continue;
      ++wanted;
      const PlaneVerdict* p = plane_of(*run, s.surface);
      if (!p) continue;
      ++found;
      const double normal = static_cast<double>(p->normal_deg), offset = static_cast<double>(p->offset_m);
      const double covered = static_cast<double>(p->covered), overstep = static_cast<double>(p->overstep);
      close += normal <= kNormalBar && offset <= kOffsetBar;
      outlined += covered >= 0.6 && overstep <= 0.2;
      worst_normal = std::max(worst_normal, normal);
      worst_offset = std::max(worst_offset, offset);
      least_covered = std::min(least_covered, covered);
      most_overstep = std::max(most_overstep, overstep);
    }
    each.push_back(run_json(*run));
  }
  return {{"true", true_planes},
          {"false", false_planes},
          {"explained", explained},
          {"duplicate", duplicates},
          {"wanted", wanted},
          {"found", found},
          {"within_2_deg_2_cm", close},
          {"outlined", outlined},
          {"nees_mean", nees.empty() ? 0 : nees_sum / static_cast<double>(nees.size())},
          {"nees_median", nees.empty() ? 0 : median(nees)},
          {"worst_normal_deg", worst_normal},
          {"worst_offset_m", worst_offset},
          {"least_covered", least_covered},
          {"most_overstep", most_overstep},
          {"each_run", each}};
}

}  // namespace pfsim
