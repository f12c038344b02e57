#include "hits.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "maths.h"
#include "text_file.h"

namespace pf::capture {

bool cast_ray(const pf_slam_t* slam, int64_t frame, const pf_pose_t& pose, const double pixel[2], Hit& hit) {
  hit = Hit{};
  if (pf_hit_test(slam, pixel, &hit.at) != PF_OK) {
    return false;
  }
  hit.frame = frame;
  hit.pixel[0] = pixel[0];
  hit.pixel[1] = pixel[1];
  hit.sigma = largest_sigma(hit.at.covariance);
  hit.plane_now = hit.at.plane;
  double variance = 0.0;
  for (size_t i = 0; i < 3; ++i) {
    for (size_t k = 0; k < 3; ++k) {
      variance += (hit.at.p_W[i] - pose.p_WC[i]) * hit.at.covariance[3 * i + k] * (hit.at.p_W[k] - pose.p_WC[k]);
    }
  }
  hit.sigma_range = hit.at.range > 0.0 ? std::sqrt(std::max(0.0, variance)) / hit.at.range : 0.0;
  return true;
}

void follow_planes(const pf_slam_t* slam, std::vector<Hit>& hits) {
  for (Hit& hit : hits) {
    uint32_t now = 0;
    hit.plane_now = pf_find_plane(slam, hit.at.plane, &now) == PF_OK ? now : 0;
  }
}

std::string describe(const Hit& hit, bool metric) {
  std::string text;
  append(text, hit.plane_now != 0 ? "plane %u" : "plane %u (gone)", hit.plane_now != 0 ? hit.plane_now : hit.at.plane);
  if (metric) {
    append(text, ", %.3g m away, sigma %.2g mm", hit.at.range, 1e3 * hit.sigma);
  } else {
    append(text, ", %.3g median depths away, sigma %.2g %%", hit.at.range, 1e2 * hit.sigma / hit.at.range);
  }
  return text;
}

nlohmann::ordered_json hits_json(const std::vector<Hit>& hits) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const Hit& hit : hits) {
    nlohmann::ordered_json one;
    one["frame"] = hit.frame;
    one["pixel"] = {hit.pixel[0], hit.pixel[1]};
    one["plane"] = hit.at.plane;
    one["plane_now"] = hit.plane_now != 0 ? nlohmann::ordered_json(hit.plane_now) : nlohmann::ordered_json();
    one["p_W"] = {hit.at.p_W[0], hit.at.p_W[1], hit.at.p_W[2]};
    one["sigma"] = hit.sigma;
    one["range"] = hit.at.range;
    one["sigma_range"] = hit.sigma_range;
    all.push_back(one);
  }
  return all;
}

}  // namespace pf::capture
