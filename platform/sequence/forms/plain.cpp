/// The plain form, which this project writes itself.
#include "form.h"
#include "lens.h"
#include "lists.h"

namespace pf::sequence {

namespace {

bool is_plain(const Fields& fields) { return fields.has_any({"fx", "fy", "cx", "cy"}); }

void read_plain(const Fields& fields, const Asked&, Calibration& calibration) {
  // Those that are not used belong to other sensors of the same device.
  Fields::Known known = known_fields(
      {"camera_model", "width", "height", "fx", "fy", "cx", "cy", "distortion_model", "distortion", "rate_hz"},
      {"comment", "T_imu_cam", "imu_rate_hz", "gyro_noise_density", "gyro_random_walk", "accel_noise_density",
       "accel_random_walk", "gravity", "depth_fx", "depth_fy", "depth_cx", "depth_cy", "depth_scale_to_m"});
  known.ours = true;
  fields.check_keys(known, calibration.notes);
  require_pinhole(fields, fields.text_or("camera_model", "pinhole"));
  pf_camera_t& camera = calibration.camera;
  camera.width = fields.integer("width");
  camera.height = fields.integer("height");
  set_pinhole({fields.number("fx"), fields.number("fy"), fields.number("cx"), fields.number("cy")}, camera);
  const std::string name =
      fields.has("distortion") ? fields.text("distortion_model") : fields.text_or("distortion_model", "none");
  const std::vector<double> coefficients =
      fields.has("distortion") || name != "none" ? fields.numbers("distortion", 14) : std::vector<double>();
  set_distortion(fields, "distortion_model", "distortion", name, coefficients, camera);
  check_lens(fields, {"width", "height", "fx", "fy", "cx", "cy", "distortion"}, camera);
  calibration.rate_hz = read_rate(fields, "rate_hz");
}

}  // namespace

const Form kPlainForm{"plain", "the plain form (width, height, fx, fy, cx, cy, distortion_model)", is_plain,
                      read_plain};

}  // namespace pf::sequence
