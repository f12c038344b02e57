/// calib.txt of KITTI's odometry sequences (P0 to P3) and calib_cam_to_cam.txt of its raw ones (P_rect_00 to P_rect_03), both of rectified
/// images.
#include <cmath>

#include "form.h"
#include "lens.h"

namespace pf::sequence {

namespace {

/// The pinhole of a projection matrix in rows of four. Its last column is where the camera is against the first.
Pinhole pinhole_of_projection(const Fields& fields, const std::string& key) {
  const std::vector<double> p = fields.numbers_in_text(key);
  if (p.size() != 12) {
    fields.refuse_field(key, "has " + std::to_string(p.size()) + " numbers; a projection matrix has 12");
  }
  if (p[1] != 0.0 || p[4] != 0.0 || p[8] != 0.0 || p[9] != 0.0 || p[10] != 1.0) {
    fields.refuse_field(key, "must have the form fx 0 cx tx, 0 fy cy ty, 0 0 1 tz (no skew)");
  }
  return {p[0], p[5], p[2], p[6]};
}

std::vector<NamedCamera> cameras_of(const Fields& fields, const std::string& before) {
  std::vector<NamedCamera> cameras;
  for (const char* number : {"0", "1", "2", "3"}) {
    if (fields.has(before + number)) {
      cameras.push_back({before + number, {std::string("image_") + number, std::string("image_0") + number}});
    }
  }
  return cameras;
}

bool is_kitti(const Fields& fields) { return fields.has_any({"P0", "P1", "P2", "P3"}); }

void read_kitti(const Fields& fields, const Asked& asked, Calibration& calibration) {
  fields.check_keys(known_fields({"P0", "P1", "P2", "P3"}, {"Tr", "Tr*", "R0_rect", "R_rect"}), calibration.notes);
  const std::vector<NamedCamera> cameras = cameras_of(fields, "P");
  const std::string key = cameras[choose_camera(fields, cameras, asked, true, calibration.notes)].name;
  calibration.camera_name = key;
  pf_camera_t& camera = calibration.camera;
  set_pinhole(pinhole_of_projection(fields, key), camera);
  camera.model = PF_CAMERA_PINHOLE;
  camera.width = asked.images.width;
  camera.height = asked.images.height;
  calibration.size_hint = "write its numbers into a calib.yaml with width and height";
  if (camera.width > 0) {
    check_lens(fields, {key, key, key, key, key, key, key}, camera);
  }
}

bool is_kitti_raw(const Fields& fields) { return !cameras_of(fields, "P_rect_0").empty(); }

void read_kitti_raw(const Fields& fields, const Asked& asked, Calibration& calibration) {
  const std::vector<NamedCamera> cameras = cameras_of(fields, "P_rect_0");
  const std::string key = cameras[choose_camera(fields, cameras, asked, true, calibration.notes)].name;
  calibration.camera_name = key;
  const std::string size_key = "S" + key.substr(1);
  std::vector<std::string> unused{"calib_time", "corner_dist", "P_rect_*", "S_rect_*"};
  for (const char* name : {"S", "K", "D", "R", "T", "R_rect"}) {
    unused.push_back(name + std::string("_0*"));
  }
  fields.check_keys(known_fields({key, size_key}, unused), calibration.notes);
  const std::vector<double> size = fields.numbers_in_text(size_key);
  if (size.size() != 2 || size[0] != std::floor(size[0]) || size[1] != std::floor(size[1]) || !(size[0] < 1e6) ||
      !(size[1] < 1e6) || !(size[0] > 0.0) || !(size[1] > 0.0)) {
    fields.refuse_field(size_key, "must be two whole numbers, width and height");
  }
  pf_camera_t& camera = calibration.camera;
  set_pinhole(pinhole_of_projection(fields, key), camera);
  camera.model = PF_CAMERA_PINHOLE;
  camera.width = static_cast<int32_t>(size[0]);
  camera.height = static_cast<int32_t>(size[1]);
  check_lens(fields, {size_key, size_key, key, key, key, key, key}, camera);
}

}  // namespace

const Form kKittiForm{"kitti", "KITTI's calib.txt (P0:)", is_kitti, read_kitti};
const Form kKittiRawForm{"kitti", "and calib_cam_to_cam.txt (P_rect_00:)", is_kitti_raw, read_kitti_raw};

}  // namespace pf::sequence
