#ifndef PLANEFOLD_CAPTURE_REJECTIONS_H
#define PLANEFOLD_CAPTURE_REJECTIONS_H

#include <planefold/planefold.h>

#include <string>
#include <vector>

namespace pf::capture {

/// Something that the user gave and that the pictures contradict.
struct Rejection {
  std::string what;  ///< "inertial unit", "wall 'north'"
  std::string line;  ///< one line: what was met, and what to do
};

/// A calibration whose numbers the estimated lens has left, by what the calibration says of itself.
/// given  as it was read; nothing is said of a lens that is not estimated
void add_rejected_calibration(const pf_slam_t* slam, const pf_camera_t& given, std::vector<Rejection>& rejections);

/// Samples that the pictures contradict.
/// inertial   poses depend on them
/// offset_s   measured between the clocks, and its sigma; sigma 0: not known
/// delay_s    that is in use, by the mounting or as estimated
/// given_s    that was added to the unit's times already
struct UnitCheck {
  bool inertial = false;
  double offset_s = 0.0, sigma_s = 0.0;
  double delay_s = 0.0, given_s = 0.0;
};
void add_rejected_unit(const pf_slam_t* slam, const UnitCheck& unit, std::vector<Rejection>& rejections);

/// "left out or contradicted by the pictures: inertial unit, wall 'north'"; "" where there is none.
std::string summary_of(const std::vector<Rejection>& rejections);

}  // namespace pf::capture

#endif
