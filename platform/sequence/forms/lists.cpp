#include "lists.h"

#include <cmath>

#include "lens.h"

namespace pf::sequence {

void require_pinhole(const Fields& fields, const std::string& text) {
  if (text != "pinhole") {
    fields.refuse_field("camera_model", "is '" + text + "'; only pinhole (with a distortion) is known");
  }
}

void read_lists(const Fields& fields, const char* coefficients_key, pf_camera_t& camera) {
  require_pinhole(fields, fields.text("camera_model"));
  const std::vector<double> size = fields.numbers("resolution", 2);
  if (size.size() != 2 || size[0] != std::floor(size[0]) || size[1] != std::floor(size[1]) ||
      std::fabs(size[0]) > 1e6 || std::fabs(size[1]) > 1e6) {
    fields.refuse_field("resolution", "must be two whole numbers, width and height");
  }
  camera.width = static_cast<int32_t>(size[0]);
  camera.height = static_cast<int32_t>(size[1]);
  const std::vector<double> values = fields.numbers("intrinsics", 4);
  if (values.size() != 4) {
    fields.refuse_field("intrinsics", "must be four numbers: fx, fy, cx, cy");
  }
  set_pinhole({values[0], values[1], values[2], values[3]}, camera);
  const std::string name = fields.text("distortion_model");
  const std::vector<double> coefficients =
      fields.has(coefficients_key) || name != "none" ? fields.numbers(coefficients_key, 14) : std::vector<double>();
  set_distortion(fields, "distortion_model", coefficients_key, name, coefficients, camera);
  check_lens(fields,
             {"resolution", "resolution", "intrinsics", "intrinsics", "intrinsics", "intrinsics", coefficients_key},
             camera);
}

}  // namespace pf::sequence
