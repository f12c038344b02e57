#include "target_distance.h"

#include <cmath>
#include <cstdio>

namespace pf::capture {

namespace {

constexpr double kFar_m = 20.0;         ///< a handheld camera starts from nearer targets
constexpr double kFarInMetres = 100.0;  ///< farther away than this, centimetres would be too far as well

double distance_to(const pf_target_t& target, const pf_pose_t& pose) {
  double square = 0.0;
  for (int i = 0; i < 3; ++i) {
    double middle = target.kind == PF_TARGET_RECTANGLE ? target.p_WT[i] : 0.0;
    for (int32_t k = 0; target.kind == PF_TARGET_POINTS && k < target.count; ++k) {
      middle += target.points_W[k][i] / target.count;
    }
    square += (pose.p_WC[i] - middle) * (pose.p_WC[i] - middle);
  }
  return std::sqrt(square);
}

}  // namespace

std::string doubt_of_target(const pf_target_t& target, const std::string& start, const pf_pose_t& pose) {
  const double distance = distance_to(target, pose);
  if (!(distance > kFar_m)) {
    return "";
  }
  const bool millimetres = distance > kFarInMetres;
  const double unit = millimetres ? 1e-3 : 1e-2;
  const char* name = millimetres ? "millimetres" : "centimetres";
  char text[400];
  if (target.kind != PF_TARGET_RECTANGLE) {
    std::snprintf(text, sizeof(text),
                  "%s: its points put the camera %.4g m away; lengths are metres: were they %s, write all of them "
                  "times %g into it",
                  start.c_str(), distance, name, unit);
  } else if (start.rfind("rectangle:", 0) == 0) {
    std::snprintf(
        text, sizeof(text),
        "--start %s: puts the camera %.4g m away; lengths are metres: were they %s, type --start rectangle:%.6gx%.6g",
        start.c_str(), distance, name, unit * target.width, unit * target.height);
  } else {
    std::snprintf(text, sizeof(text),
                  "%s: its rectangle of %.6g x %.6g m puts the camera %.4g m away; lengths are metres: were they %s, "
                  "write width: %.6g "
                  "and height: %.6g into it",
                  start.c_str(), target.width, target.height, distance, name, unit * target.width,
                  unit * target.height);
  }
  return text;
}

}  // namespace pf::capture
