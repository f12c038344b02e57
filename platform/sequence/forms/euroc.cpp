/// EuRoC's sensor.yaml of a camera.
#include "form.h"
#include "lists.h"

namespace pf::sequence {

namespace {

bool is_euroc(const Fields& fields) {
  return fields.has_any({"intrinsics", "resolution"}) ||
         (fields.has("camera_model") && fields.has("distortion_coefficients"));
}

void read_euroc(const Fields& fields, const Asked&, Calibration& calibration) {
  fields.check_keys(known_fields({"camera_model", "distortion_coefficients", "distortion_model", "intrinsics",
                                  "resolution", "rate_hz"},
                                 {"sensor_type", "comment", "T_BS"}),
                    calibration.notes);
  if (fields.text_or("sensor_type", "camera") != "camera") {
    fields.refuse_field("sensor_type", "is '" + fields.text("sensor_type") + "'; that of a camera is needed");
  }
  read_lists(fields, "distortion_coefficients", calibration.camera);
  calibration.rate_hz = read_rate(fields, "rate_hz");
}

}  // namespace

const Form kEurocForm{"euroc", "EuRoC's sensor.yaml (intrinsics:, resolution:)", is_euroc, read_euroc};

}  // namespace pf::sequence
