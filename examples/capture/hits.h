#ifndef PLANEFOLD_CAPTURE_HITS_H
#define PLANEFOLD_CAPTURE_HITS_H

#include <planefold/planefold.h>

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace pf::capture {

/// A point of a plane that the user pointed at.
struct Hit {
  int64_t frame = 0;
  double pixel[2] = {0.0, 0.0};
  pf_hit_t at{};
  double sigma = 0.0;        ///< of the point, along its worst direction [m]
  double sigma_range = 0.0;  ///< along the ray [m]
  uint32_t plane_now = 0;    ///< what its plane's id stands for now: planes merge. 0: the plane is gone
};

/// Casts a ray through a pixel of the last frame onto the planes. false: it meets none.
bool cast_ray(const pf_slam_t* slam, int64_t frame, const pf_pose_t& pose, const double pixel[2], Hit& hit);

/// Follows the planes' ids.
void follow_planes(const pf_slam_t* slam, std::vector<Hit>& hits);

/// "plane 3, 0.82 m away, sigma 4 mm"; lengths in metres only where the scale is known.
std::string describe(const Hit& hit, bool metric);

/// [{frame, pixel, plane, plane_now, p_W, sigma, range, sigma_range}] of report.json.
nlohmann::ordered_json hits_json(const std::vector<Hit>& hits);

}  // namespace pf::capture

#endif
