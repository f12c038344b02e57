#ifndef PLANEFOLD_PLATFORM_SEQUENCE_FORMS_LISTS_H
#define PLANEFOLD_PLATFORM_SEQUENCE_FORMS_LISTS_H

#include <planefold/planefold.h>

#include "../yaml_fields.h"

namespace pf::sequence {

/// The fields of Kalibr and EuRoC (camera_model, resolution, intrinsics, distortion_model), which differ in the name of the coefficients.
void read_lists(const Fields& fields, const char* coefficients_key, pf_camera_t& camera);

/// camera_model is pinhole; text is what it is.
void require_pinhole(const Fields& fields, const std::string& text);

}  // namespace pf::sequence

#endif
