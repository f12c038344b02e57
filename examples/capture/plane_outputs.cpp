#include "plane_outputs.h"

#include <nlohmann/json.hpp>

#include "plane_colour.h"
#include "text_file.h"

namespace pf::capture {

namespace {

int level(double part) { return static_cast<int>(255.0 * part + 0.5); }

}  // namespace

std::string to_ply(const std::vector<pf_feature_t>& features, const std::vector<double>& sigmas_in_map,
                   const std::vector<PlaneView>& planes) {
  std::string text;
  const bool in_map = !sigmas_in_map.empty();
  size_t corners = 0;
  size_t faces = 0;
  for (const PlaneView& plane : planes) {
    corners += plane.outline.size() >= 3 ? plane.outline.size() : 0;
    faces += plane.outline.size() >= 3 ? 1 : 0;
  }
  append(text,
         "ply\nformat ascii 1.0\ncomment points in W; green: 3-D point, blue: inverse depth, magenta: target\n"
         "comment the last %zu vertices are the corners of planes, in the planes' colours, with their ids\n"
         "element vertex %zu\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\n"
         "property uchar green\nproperty uchar blue\nproperty float sigma\nproperty uint id\n"
         "property int observations\nproperty uchar inverse_depth\n%s",
         corners, features.size() + corners,
         in_map ? "comment the next is sigma without the place, turn and scale that the whole map shares\n"
                  "property float sigma_in_map\n"
                : "");
  if (faces > 0) {  // trimesh fails on an element of which there is none
    append(text,
           "element face %zu\nproperty list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\n"
           "property uchar blue\nproperty uint id\n",
           faces);
  }
  append(text, "end_header\n");
  for (size_t i = 0; i < features.size(); ++i) {
    const pf_feature_t& f = features[i];
    const bool depth = f.kind == PF_FEATURE_INVERSE_DEPTH;
    const char* colour = f.is_target != 0 ? "224 80 208" : depth ? "63 160 255" : "53 208 127";
    append(text, "%.9g %.9g %.9g %s %.6g %u %d %d", f.p_W[0], f.p_W[1], f.p_W[2], colour, largest_sigma(f.covariance),
           f.id, f.observations, depth ? 1 : 0);
    if (in_map) {
      append(text, " %.6g", sigmas_in_map[i]);
    }
    append(text, "\n");
  }
  for (const PlaneView& plane : planes) {
    const PlaneColour c = plane_colour(plane.id);
    for (size_t i = 0; plane.outline.size() >= 3 && i < plane.outline.size(); ++i) {
      const Vec3& p = plane.outline[i];
      append(text, "%.9g %.9g %.9g %d %d %d %.6g %u %d 0%s\n", p[0], p[1], p[2], level(c.r), level(c.g), level(c.b),
             plane.sigma, plane.id, plane.points, in_map ? " 0" : "");
    }
  }
  size_t first = features.size();
  for (const PlaneView& plane : planes) {
    if (plane.outline.size() < 3) {
      continue;
    }
    const PlaneColour c = plane_colour(plane.id);
    append(text, "%zu", plane.outline.size());
    for (size_t i = 0; i < plane.outline.size(); ++i) {
      append(text, " %zu", first++);
    }
    append(text, " %d %d %d %u\n", level(c.r), level(c.g), level(c.b), plane.id);
  }
  return text;
}

nlohmann::ordered_json planes_json(const std::vector<PlaneView>& planes) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const PlaneView& plane : planes) {
    nlohmann::ordered_json one;
    one["id"] = plane.id;
    one["normal"] = plane.normal;
    one["distance"] = plane.distance;
    one["sigma"] = plane.sigma;
    one["sigma_normal_deg"] = plane.sigma_normal * 57.29577951308232;
    one["points"] = plane.points;
    one["fixed_points"] = plane.fixed_points;
    one["members"] = plane.points - plane.trial;
    one["trial"] = plane.trial;
    one["area_m2"] = plane.area();
    one["orientation"] = plane.orientation;
    one["outline"] = plane.outline;
    all.push_back(one);
  }
  return all;
}

}  // namespace pf::capture
