/// Kalibr's camchain, of one camera or several, and OpenVINS' kalibr_imucam_chain.
#include <algorithm>

#include "form.h"
#include "lists.h"

namespace pf::sequence {

std::vector<NamedCamera> kalibr_cameras(const Fields& fields) {
  std::vector<NamedCamera> cameras;
  for (const std::string& key : fields.keys()) {
    if (key.size() > 3 && key.size() < 6 && key.compare(0, 3, "cam") == 0 &&
        key.find_first_not_of("0123456789", 3) == std::string::npos) {
      cameras.push_back({key, {}});
    }
  }
  std::sort(cameras.begin(), cameras.end(), [](const NamedCamera& a, const NamedCamera& b) {
    return std::stoi(a.name.substr(3)) < std::stoi(b.name.substr(3));
  });
  const auto same = [](const NamedCamera& a, const NamedCamera& b) { return a.name == b.name; };
  cameras.erase(std::unique(cameras.begin(), cameras.end(), same), cameras.end());
  return cameras;
}

namespace {

const std::vector<std::string> kCamera{"camera_model", "distortion_coeffs", "distortion_model",
                                       "intrinsics",   "resolution",        "rate_hz"};
/// The mounting is read by pf_read_imu_mount.
const std::vector<std::string> kBeside{"rostopic",          "cam_overlaps", "T_cn_cnm1",   "T_cam_imu", "T_imu_cam",
                                       "timeshift_cam_imu", "T_BS",         "sensor_type", "comment"};

bool is_kalibr(const Fields& fields) {
  return !kalibr_cameras(fields).empty() ||
         (fields.has("distortion_coeffs") && fields.has_any({"intrinsics", "resolution"}));
}

void read_kalibr(const Fields& fields, const Asked& asked, Calibration& calibration) {
  const std::vector<NamedCamera> cameras = kalibr_cameras(fields);
  pf_camera_t& camera = calibration.camera;
  if (cameras.empty()) {
    fields.check_keys(known_fields(kCamera, kBeside), calibration.notes);
    read_lists(fields, "distortion_coeffs", camera);
    calibration.rate_hz = read_rate(fields, "rate_hz");
    return;
  }
  Fields::Known above = known_fields({});
  for (const NamedCamera& named : cameras) {
    above.read.push_back(named.name);
  }
  fields.check_keys(above, calibration.notes);
  const std::string name = cameras[choose_camera(fields, cameras, asked, false, calibration.notes)].name;
  calibration.camera_name = calibration.section = name;
  const Fields chosen = fields.below(name);
  chosen.check_keys(known_fields(kCamera, kBeside), calibration.notes);
  read_lists(chosen, "distortion_coeffs", camera);
  calibration.rate_hz = read_rate(chosen, "rate_hz");
}

}  // namespace

const Form kKalibrForm{"kalibr", "Kalibr's and OpenVINS' camchain (cam0:)", is_kalibr, read_kalibr};

}  // namespace pf::sequence
