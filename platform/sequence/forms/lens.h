#ifndef PLANEFOLD_PLATFORM_SEQUENCE_FORMS_LENS_H
#define PLANEFOLD_PLATFORM_SEQUENCE_FORMS_LENS_H

#include <planefold/planefold.h>

#include <string>
#include <vector>

#include "../yaml_fields.h"

namespace pf::sequence {

/// The names of the fields, for messages.
struct LensNames {
  std::string width, height, fx, fy, cx, cy, distortion;
};

/// A pinhole's numbers [px].
struct Pinhole {
  double fx, fy, cx, cy;
};

void set_pinhole(const Pinhole& pinhole, pf_camera_t& camera);

/// The pinhole of a matrix fx 0 cx, 0 fy cy, 0 0 1, refused where it has skew or another last row.
Pinhole pinhole_of(const Fields& fields, const std::string& key, const std::vector<double>& K);

/// Model and coefficients by the model's name, as Kalibr, EuRoC, ROS, OpenCV and the plain form have it. Coefficients that the library's
/// model of that name does not have must be zero.
/// name_key, list_key  fields that they come from, for messages
void set_distortion(const Fields& fields, const std::string& name_key, const std::string& list_key,
                    const std::string& name, const std::vector<double>& coefficients, pf_camera_t& camera);

/// Sizes, focal lengths and centre are those of a camera that there can be.
void check_lens(const Fields& fields, const LensNames& names, const pf_camera_t& camera);

std::string format_number(double value);

}  // namespace pf::sequence

#endif
