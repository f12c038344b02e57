/// Settings of ORB-SLAM3 (Camera1.fx), of its predecessors (Camera.fx), and of their stereo examples (LEFT.K).
#include "form.h"
#include "lens.h"
#include "prefixed.h"

namespace pf::sequence {

namespace {

/// The files hold the settings of the whole program.
const std::vector<std::string> kSettings{"Camera.bf",
                                         "Camera.RGB",
                                         "Camera.newWidth",
                                         "Camera.newHeight",
                                         "Camera.imageScale",
                                         "Camera1.overlapping*",
                                         "Camera2.overlapping*",
                                         "Camera.lapping*",
                                         "Tlr",
                                         "T_c1_c2",
                                         "Tbc",
                                         "ThDepth",
                                         "DepthMapFactor",
                                         "thFarPoints",
                                         "Stereo.*",
                                         "RGBD.*",
                                         "IMU.*",
                                         "ORBextractor.*",
                                         "Viewer.*",
                                         "System.*",
                                         "File.version",
                                         "loopClosing"};

/// "PinHole", "KannalaBrandt8" or "Rectified".
std::string type_of(const Fields& fields) {
  const std::string type = fields.text_or("Camera.type", "PinHole");
  if (type != "PinHole" && type != "KannalaBrandt8" && type != "Rectified") {
    fields.refuse_field("Camera.type", "is '" + type + "'; known are PinHole, KannalaBrandt8 and Rectified");
  }
  return type;
}

void read_prefix(const Fields& fields, const std::string& prefix, std::vector<std::string> unused, const Asked& asked,
                 Calibration& calibration) {
  const std::string type = type_of(fields);
  const bool is_fisheye = type == "KannalaBrandt8";
  const std::vector<std::string> coefficients =
      type == "Rectified" ? std::vector<std::string>() : coefficient_names(is_fisheye);
  for (size_t i = 0; is_fisheye && i < coefficients.size(); ++i) {
    fields.number(prefix + coefficients[i]);
  }
  unused.insert(unused.end(), kSettings.begin(), kSettings.end());
  const PrefixedNames names{prefix, "Camera.width", "Camera.height", "Camera.fps", "Camera.type"};
  fields.check_keys(known_prefixed(names, coefficients, unused), calibration.notes);
  calibration.size_hint = "add Camera.width and Camera.height";
  read_prefixed(fields, names, is_fisheye, coefficients, asked, calibration);
}

bool has_camera(const Fields& fields, const std::string& prefix) {
  return fields.has_any({prefix + "fx", prefix + "fy"}) && fields.has_any({prefix + "cx", prefix + "cy"});
}

void read_orb_slam3(const Fields& fields, const Asked& asked, Calibration& calibration) {
  std::vector<NamedCamera> cameras{{"Camera1", {"cam0"}}};
  if (has_camera(fields, "Camera2.")) {
    cameras.push_back({"Camera2", {"cam1"}});
  }
  const bool second = choose_camera(fields, cameras, asked, false, calibration.notes) == 1;
  calibration.camera_name = cameras[second ? 1 : 0].name;
  read_prefix(fields, second ? "Camera2." : "Camera1.", {second ? "Camera1.*" : "Camera2.*"}, asked, calibration);
}

/// A camera of a stereo rig as it takes its images: LEFT.K, LEFT.D.
void read_side(const Fields& fields, const std::string& side, Calibration& calibration) {
  const std::string width = side + ".width", height = side + ".height", K = side + ".K", D = side + ".D";
  std::vector<std::string> unused = kSettings;
  unused.insert(unused.end(), {"Camera.*", "LEFT.*", "RIGHT.*"});
  fields.check_keys(known_fields({width, height, K, D, "Camera.fps"}, unused), calibration.notes);
  if (type_of(fields) != "PinHole") {
    fields.refuse_field("Camera.type", "is '" + type_of(fields) + "'; beside " + K + " it must be PinHole");
  }
  pf_camera_t& camera = calibration.camera;
  camera.width = fields.integer(width);
  camera.height = fields.integer(height);
  set_pinhole(pinhole_of(fields, K, fields.matrix(K, 3, 3)), camera);
  set_distortion(fields, "Camera.type", D, "radtan", fields.vector(D, 14), camera);
  check_lens(fields, {width, height, K, K, K, K, D}, camera);
  calibration.rate_hz = read_rate(fields, "Camera.fps");
}

void read_orb_slam(const Fields& fields, const Asked& asked, Calibration& calibration) {
  std::vector<NamedCamera> cameras{{"Camera", {}}};
  for (const char* side : {"LEFT", "RIGHT"}) {
    if (fields.has(side + std::string(".K"))) {
      cameras.push_back({side, {}});
    }
  }
  if (cameras.size() > 1 && asked.camera.empty()) {
    fields.refuse_field(cameras[1].name + ".K",
                        "says that Camera.fx is of rectified images; --camera Camera takes its numbers, and --camera " +
                            cameras[1].name + " those of images as the camera gives them");
  }
  const std::string name = cameras[choose_camera(fields, cameras, asked, false, calibration.notes)].name;
  calibration.camera_name = name;
  if (name == "Camera") {
    read_prefix(fields, "Camera.", {"LEFT.*", "RIGHT.*"}, asked, calibration);
  } else {
    read_side(fields, name, calibration);
  }
}

bool is_orb_slam3(const Fields& fields) { return fields.has_any({"Camera1.fx", "Camera1.fy"}); }

bool is_orb_slam(const Fields& fields) { return fields.has_any({"Camera.fx", "Camera.fy"}); }

}  // namespace

const Form kOrbSlam3Form{"orb-slam3", "ORB-SLAM3 (Camera1.fx:)", is_orb_slam3, read_orb_slam3};
const Form kOrbSlamForm{"orb-slam", "ORB-SLAM (Camera.fx:)", is_orb_slam, read_orb_slam};

}  // namespace pf::sequence
