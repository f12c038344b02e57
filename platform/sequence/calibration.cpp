#include "calibration.h"

#include <algorithm>
#include <cmath>

#include "file.h"
#include "numbers.h"
#include "refuse.h"
#include "yaml_fields.h"

namespace pf::sequence {

namespace {

struct Model {
  const char* name;
  pf_camera_model_t model;
  size_t fewest, most;  ///< distortion coefficients
};

/// Names that Kalibr, EuRoC, ROS, OpenCV and the plain form give to the models.
constexpr Model kModels[] = {
    {"none", PF_CAMERA_PINHOLE, 0, 0},
    {"radtan", PF_CAMERA_RADTAN, 4, 5},
    {"radial-tangential", PF_CAMERA_RADTAN, 4, 5},
    {"plumb_bob", PF_CAMERA_RADTAN, 4, 5},
    {"rational_polynomial", PF_CAMERA_RADTAN, 5, 8},
    {"equidistant", PF_CAMERA_EQUIDISTANT, 4, 4},
    {"fisheye", PF_CAMERA_EQUIDISTANT, 4, 4},
    {"harris_division", PF_CAMERA_DIVISION, 1, 1},
    {"division", PF_CAMERA_DIVISION, 1, 1},
};

const Fields::Known kKalibr{
    {"camera_model", "distortion_coeffs", "distortion_model", "intrinsics", "resolution", "rate_hz", "readout_s",
     "sigma_focal", "sigma_aspect", "sigma_centre_px", "sigma_distortion"},
    {"rostopic", "cam_overlaps", "T_cn_cnm1", "T_cam_imu", "timeshift_cam_imu", "T_BS", "sensor_type", "comment"}};
const Fields::Known kKalibrChain{
    {"cam0", "readout_s", "timestamps", "sigma_focal", "sigma_aspect", "sigma_centre_px", "sigma_distortion"},
    {"cam1", "cam2", "cam3", "cam4", "cam5", "cam6", "cam7"}};
const Fields::Known kEuroc{
    {"camera_model", "distortion_coefficients", "distortion_model", "intrinsics", "resolution", "rate_hz", "readout_s",
     "timestamps", "sigma_focal", "sigma_aspect", "sigma_centre_px", "sigma_distortion"},
    {"sensor_type", "comment", "T_BS"}};
const Fields::Known kRos{
    {"image_width", "image_height", "camera_matrix", "distortion_model", "distortion_coefficients", "readout_s",
     "timestamps", "sigma_focal", "sigma_aspect", "sigma_centre_px", "sigma_distortion"},
    {"camera_name", "rectification_matrix", "projection_matrix"}};
/// Files of ORB-SLAM hold the settings of the whole program.
const std::vector<std::string> kOrbSlamSettings{"Camera.bf",
                                                "Camera.RGB",
                                                "Camera.newWidth",
                                                "Camera.newHeight",
                                                "Camera.imageScale",
                                                "Camera2.*",
                                                "Camera1.overlapping*",
                                                "Camera2.overlapping*",
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
                                                "LEFT.*",
                                                "RIGHT.*",
                                                "loopClosing"};
const Fields::Known kKitti{{"P0", "readout_s", "sigma_focal", "sigma_aspect", "sigma_centre_px", "sigma_distortion"},
                           {"P1", "P2", "P3", "Tr", "Tr*"}};
/// Those that are not used belong to other sensors of the same device.
const Fields::Known kPlain{
    {"camera_model", "width", "height", "fx", "fy", "cx", "cy", "distortion_model", "distortion", "rate_hz",
     "readout_s", "timestamps", "sigma_focal", "sigma_aspect", "sigma_centre_px", "sigma_distortion"},
    {"comment", "T_imu_cam", "imu_rate_hz", "gyro_noise_density", "gyro_random_walk", "accel_noise_density",
     "accel_random_walk", "gravity", "depth_fx", "depth_fy", "depth_cx", "depth_cy", "depth_scale_to_m"},
    true};

/// What the message about an unknown layout offers.
constexpr const char* kLayouts =
    "Kalibr's camchain (cam0:), EuRoC's sensor.yaml (intrinsics:, resolution:), ROS camera_info and OpenCV "
    "(camera_matrix:), "
    "ORB-SLAM3 (Camera1.fx:) and ORB-SLAM (Camera.fx:), KITTI's calib.txt (P0:), and the plain form (width, height, "
    "fx, fy, cx, cy, "
    "distortion_model)";

std::string format(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%g", value);
  return text;
}

void set_distortion(const Fields& fields, const std::string& name_key, const std::string& list_key,
                    const std::string& name, const std::vector<double>& coefficients, pf_camera_t& camera) {
  const Model* model =
      std::find_if(std::begin(kModels), std::end(kModels), [&](const Model& m) { return name == m.name; });
  if (model == std::end(kModels)) {
    fields.refuse_field(name_key, "is '" + name +
                                      "'; known are none, radtan, equidistant, plumb_bob, rational_polynomial "
                                      "(with zeros after the fifth) and harris_division");
  }
  // Zeros at the end say nothing: ROS writes five of them for a camera without distortion.
  size_t used = coefficients.size();
  while (used > 0 && coefficients[used - 1] == 0.0) {
    --used;
  }
  if (used > (model->model == PF_CAMERA_RADTAN ? 5 : model->most)) {
    fields.refuse_field(list_key, "has " + std::to_string(used) + " coefficients; '" + name + "' can use " +
                                      std::to_string(std::min<size_t>(model->most, 5)));
  }
  if (coefficients.size() < model->fewest && !(coefficients.empty() && model->model == PF_CAMERA_RADTAN)) {
    fields.refuse_field(list_key, "has " + std::to_string(coefficients.size()) + " coefficients; '" + name +
                                      "' needs " + std::to_string(model->fewest));
  }
  camera.model = model->model;
  if (model->model == PF_CAMERA_RADTAN && used == 0) {
    camera.model = PF_CAMERA_PINHOLE;
  }
  for (size_t i = 0; i < used; ++i) {
    if (std::fabs(coefficients[i]) > 100.0) {
      fields.refuse_field(list_key, "has the absurd coefficient " + format(coefficients[i]));
    }
    camera.distortion[i] = coefficients[i];
  }
}

/// Where the four numbers of the pinhole came from, for messages.
struct IntrinsicNames {
  const char *width, *height, *fx, *fy, *cx, *cy, *distortion;
};

void check(const Fields& fields, const IntrinsicNames& names, const pf_camera_t& camera) {
  const auto side = [&](const char* key, int value) {
    if (value < 32 || value > 4096) {
      fields.refuse_field(key, "is " + std::to_string(value) + " px; 32 to 4096 are possible");
    }
  };
  side(names.width, camera.width);
  side(names.height, camera.height);
  const auto focal = [&](const char* key, double value, int size) {
    if (!(value > 0.05 * size) || value > 50.0 * size) {
      fields.refuse_field(key, "says a focal length of " + format(value) + " px, which is absurd for an image of " +
                                   std::to_string(size) + " px");
    }
  };
  focal(names.fx, camera.fx, camera.width);
  focal(names.fy, camera.fy, camera.height);
  if (camera.fx > 2.0 * camera.fy || camera.fy > 2.0 * camera.fx) {
    fields.refuse_field(names.fy, "makes pixels more than twice as high as wide or the reverse (fx " +
                                      format(camera.fx) + ", fy " + format(camera.fy) + ")");
  }
  const auto centre = [&](const char* key, double value, int size) {
    if (!(value >= 0.0) || value > size - 1.0) {
      fields.refuse_field(key, "says a principal point at " + format(value) + " px, outside of the image of " +
                                   std::to_string(size) + " px");
    }
  };
  centre(names.cx, camera.cx, camera.width);
  centre(names.cy, camera.cy, camera.height);
  if (camera.model == PF_CAMERA_DIVISION) {
    // r_u = r_d / sqrt(1 - 2 k r_d^2) must exist up to the farthest corner.
    const double x = std::max(camera.cx, camera.width - camera.cx);
    const double y = std::max(camera.cy, camera.height - camera.cy);
    if (2.0 * camera.distortion[0] * (x * x + y * y) >= 1.0) {
      fields.refuse_field(names.distortion, "is too strong (" + format(camera.distortion[0]) +
                                                " 1/px^2): the image's corners would have no ray");
    }
  }
}

void set_intrinsics(pf_camera_t& camera, double fx, double fy, double cx, double cy) {
  camera.fx = fx;
  camera.fy = fy;
  camera.cx = cx;
  camera.cy = cy;
}

/// Lists of Kalibr and EuRoC, which differ in the name of the coefficients only.
void read_lists(const Fields& fields, const char* coefficients_key, pf_camera_t& camera) {
  const std::string model = fields.text("camera_model");
  if (model != "pinhole") {
    fields.refuse_field("camera_model", "is '" + model + "'; only pinhole (with a distortion) is known");
  }
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
  set_intrinsics(camera, values[0], values[1], values[2], values[3]);
  const std::string name = fields.text("distortion_model");
  const std::vector<double> coefficients =
      fields.has(coefficients_key) || name != "none" ? fields.numbers(coefficients_key, 14) : std::vector<double>();
  set_distortion(fields, "distortion_model", coefficients_key, name, coefficients, camera);
  check(fields, {"resolution", "resolution", "intrinsics", "intrinsics", "intrinsics", "intrinsics", coefficients_key},
        camera);
}

void read_ros(const Fields& fields, pf_camera_t& camera) {
  camera.width = fields.integer("image_width");
  camera.height = fields.integer("image_height");
  const Fields matrix = fields.below("camera_matrix");
  const std::vector<double> k = matrix.numbers("data", 9);
  if (k.size() != 9) {
    matrix.refuse_field("data", "must be nine numbers");
  }
  if (k[1] != 0.0 || k[3] != 0.0 || k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0) {
    matrix.refuse_field("data", "must have the form fx 0 cx, 0 fy cy, 0 0 1 (no skew)");
  }
  set_intrinsics(camera, k[0], k[4], k[2], k[5]);
  const std::string name = fields.text_or("distortion_model", "plumb_bob");
  const std::vector<double> coefficients = fields.has("distortion_coefficients")
                                               ? fields.below("distortion_coefficients").numbers("data", 14)
                                               : std::vector<double>();
  set_distortion(fields, "distortion_model", "distortion_coefficients.data", name, coefficients, camera);
  const char* data = "camera_matrix.data";
  check(fields, {"image_width", "image_height", data, data, data, data, "distortion_coefficients.data"}, camera);
}

void read_plain(const Fields& fields, pf_camera_t& camera) {
  const std::string model = fields.text_or("camera_model", "pinhole");
  if (model != "pinhole") {
    fields.refuse_field("camera_model", "is '" + model + "'; only pinhole (with a distortion) is known");
  }
  camera.width = fields.integer("width");
  camera.height = fields.integer("height");
  set_intrinsics(camera, fields.number("fx"), fields.number("fy"), fields.number("cx"), fields.number("cy"));
  const std::string name =
      fields.has("distortion") ? fields.text("distortion_model") : fields.text_or("distortion_model", "none");
  const std::vector<double> coefficients =
      fields.has("distortion") || name != "none" ? fields.numbers("distortion", 14) : std::vector<double>();
  set_distortion(fields, "distortion_model", "distortion", name, coefficients, camera);
  check(fields, {"width", "height", "fx", "fy", "cx", "cy", "distortion"}, camera);
}

/// From the first row to the last [s]; zero where the file says nothing of it.
double read_readout(const Fields& fields) {
  const double readout = fields.number_or("readout_s", 0.0);
  if (!(readout >= 0.0 && readout <= 0.2)) {
    fields.refuse_field("readout_s", "is " + format(readout) + "; a rolling shutter takes 0 to 0.2 s");
  }
  return readout;
}

/// How well the numbers are known. Where the file says nothing, what is typical: focal lengths within 1 %, one against the other within
/// 0.1 %, the centre within 1 % of the width; distortion as exact, or, where none is named, k1 within 0.05.
void read_sigmas(const Fields& fields, pf_camera_t& camera) {
  const auto sigma = [&](const char* key, double otherwise, double lowest, double highest) {
    const double value = fields.number_or(key, otherwise);
    if (!(value >= lowest && value <= highest)) {
      fields.refuse_field(key, "is " + format(value) + "; a standard deviation of " + format(lowest) + " to " +
                                   format(highest) + " is possible");
    }
    return value;
  };
  camera.sigma_focal = sigma("sigma_focal", 0.01, 1e-5, 0.2);
  camera.sigma_aspect = sigma("sigma_aspect", 0.001, 1e-6, 0.2);
  camera.sigma_centre_px = sigma("sigma_centre_px", camera.width > 0 ? 0.01 * camera.width : 1.0, 1e-3, 1e3);
  const size_t most = camera.model == PF_CAMERA_RADTAN ? 5 : camera.model == PF_CAMERA_EQUIDISTANT ? 4 : 1;
  if (!fields.has("sigma_distortion")) {
    camera.sigma_distortion[0] = camera.model == PF_CAMERA_PINHOLE ? 0.05 : 0.0;
    return;
  }
  const std::vector<double> values = fields.numbers("sigma_distortion", 8);
  if (values.size() > most) {
    fields.refuse_field("sigma_distortion", "has " + std::to_string(values.size()) + " numbers; this distortion has " +
                                                std::to_string(most));
  }
  for (size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] >= 0.0 && values[i] <= 1.0)) {
      fields.refuse_field("sigma_distortion",
                          "has " + format(values[i]) + "; standard deviations of 0 (exact) to 1 are possible");
    }
    camera.sigma_distortion[i] = values[i];
  }
}

/// Whether the times of frames were measured; they count as measured where the file says nothing of it.
pf_timestamps_t read_timestamps(const Fields& fields) {
  const std::string name = fields.text_or("timestamps", "real");
  if (name != "real" && name != "nominal") {
    fields.refuse_field("timestamps", "is '" + name + "'; known are real (measured) and nominal (counted)");
  }
  return name == "nominal" ? PF_TIMESTAMPS_NOMINAL : PF_TIMESTAMPS_REAL;
}

double read_rate(const Fields& fields, const char* key) {
  const double rate = fields.number_or(key, 0.0);
  if (rate != 0.0 && !(rate >= 0.1 && rate <= 10000.0)) {
    fields.refuse_field(key, "is " + format(rate) + "; 0.1 to 10000 frames per second are possible");
  }
  return rate;
}

/// Files of ORB-SLAM3 (prefix Camera1.) and of its predecessors (prefix Camera.).
void read_orb_slam(const Fields& fields, const std::string& prefix, ImageSize images, Calibration& calibration) {
  const std::string type = fields.text_or("Camera.type", "PinHole");
  if (type != "PinHole" && type != "KannalaBrandt8" && type != "Rectified") {
    fields.refuse_field("Camera.type", "is '" + type + "'; known are PinHole, KannalaBrandt8 and Rectified");
  }
  const bool fisheye = type == "KannalaBrandt8";
  std::vector<std::string> names{"k1", "k2", "p1", "p2", "k3"};
  if (fisheye) {
    names = {"k1", "k2", "k3", "k4"};
  } else if (type == "Rectified") {
    names.clear();
  }
  Fields::Known known{{"Camera.type", "Camera.width", "Camera.height", "Camera.fps", "readout_s", "timestamps",
                       "sigma_focal", "sigma_aspect", "sigma_centre_px", "sigma_distortion"},
                      kOrbSlamSettings};
  for (const char* name : {"fx", "fy", "cx", "cy"}) {
    known.read.push_back(prefix + name);
  }
  std::vector<double> coefficients;
  for (const std::string& name : names) {
    known.read.push_back(prefix + name);
    coefficients.push_back(fisheye ? fields.number(prefix + name) : fields.number_or(prefix + name, 0.0));
  }
  calibration.warning = fields.check_keys(known);
  calibration.rate_hz = read_rate(fields, "Camera.fps");
  pf_camera_t& camera = calibration.camera;
  const bool has_size = fields.has("Camera.width") || fields.has("Camera.height");
  camera.width = has_size ? fields.integer("Camera.width") : images.width;
  camera.height = has_size ? fields.integer("Camera.height") : images.height;
  const std::string fx = prefix + "fx", fy = prefix + "fy", cx = prefix + "cx", cy = prefix + "cy", k1 = prefix + "k1";
  set_intrinsics(camera, fields.number(fx), fields.number(fy), fields.number(cx), fields.number(cy));
  set_distortion(fields, "Camera.type", k1, fisheye ? "equidistant" : "radtan", coefficients, camera);
  if (has_size || images.width > 0) {
    check(fields, {"Camera.width", "Camera.height", fx.c_str(), fy.c_str(), cx.c_str(), cy.c_str(), k1.c_str()},
          camera);
  }
}

/// calib.txt of KITTI's odometry sequences, of which P0 is the projection matrix of the left grey camera; rectified images.
void read_kitti(const Fields& fields, ImageSize images, pf_camera_t& camera) {
  std::vector<double> p;
  const std::string text = fields.text("P0");
  for (const Row& row : split_rows(text)) {
    for (const std::string_view word : row.words) {
      double value = 0.0;
      if (!parse_double(word, value) || !std::isfinite(value)) {
        fields.refuse_field("P0", "holds '" + std::string(word) + "', which is not a finite number");
      }
      p.push_back(value);
    }
  }
  if (p.size() != 12) {
    fields.refuse_field("P0", "has " + std::to_string(p.size()) + " numbers; a projection matrix has 12");
  }
  if (p[1] != 0.0 || p[3] != 0.0 || p[4] != 0.0 || p[7] != 0.0 || p[8] != 0.0 || p[9] != 0.0 || p[10] != 1.0 ||
      p[11] != 0.0) {
    fields.refuse_field("P0", "must have the form fx 0 cx 0, 0 fy cy 0, 0 0 1 0 (no skew, no offset)");
  }
  camera.model = PF_CAMERA_PINHOLE;
  camera.width = images.width;
  camera.height = images.height;
  set_intrinsics(camera, p[0], p[5], p[2], p[6]);
  if (images.width > 0) {
    check(fields, {"P0", "P0", "P0", "P0", "P0", "P0", "P0"}, camera);
  }
}

}  // namespace

Calibration parse_calibration(const std::string& text, const std::string& file, ImageSize images) {
  const Fields fields(text, file);
  Calibration calibration{};
  calibration.camera.readout_s = read_readout(fields);
  calibration.camera.timestamps = read_timestamps(fields);
  if (fields.has("cam0")) {
    const Fields cam0 = fields.below("cam0");
    calibration.form = "kalibr";
    const std::string above = fields.check_keys(kKalibrChain);
    calibration.warning = cam0.check_keys(kKalibr);
    calibration.warning = calibration.warning.empty() ? above : calibration.warning;
    read_lists(cam0, "distortion_coeffs", calibration.camera);
    calibration.camera.readout_s = std::max(calibration.camera.readout_s, read_readout(cam0));
    calibration.camera.timestamps = std::max<int32_t>(calibration.camera.timestamps, read_timestamps(cam0));
  } else if (fields.has("image_width") || fields.has("camera_matrix")) {
    calibration.form = "ros";
    calibration.warning = fields.check_keys(kRos);
    read_ros(fields, calibration.camera);
  } else if (fields.has("intrinsics") || fields.has("resolution")) {
    const bool kalibr = fields.has("distortion_coeffs");
    calibration.form = kalibr ? "kalibr" : "euroc";
    calibration.warning = fields.check_keys(kalibr ? kKalibr : kEuroc);
    read_lists(fields, kalibr ? "distortion_coeffs" : "distortion_coefficients", calibration.camera);
    calibration.rate_hz = read_rate(fields, "rate_hz");
  } else if (fields.has_any({"Camera1.fx", "Camera1.fy"})) {
    calibration.form = "orb-slam3";
    read_orb_slam(fields, "Camera1.", images, calibration);
  } else if (fields.has_any({"Camera.fx", "Camera.fy"})) {
    calibration.form = "orb-slam";
    read_orb_slam(fields, "Camera.", images, calibration);
  } else if (fields.has("P0")) {
    calibration.form = "kitti";
    calibration.warning = fields.check_keys(kKitti);
    read_kitti(fields, images, calibration.camera);
  } else if (fields.has_any({"width", "height", "fx", "fy", "cx", "cy", "camera_model", "distortion_model"})) {
    calibration.form = "plain";
    calibration.warning = fields.check_keys(kPlain);
    read_plain(fields, calibration.camera);
    calibration.rate_hz = read_rate(fields, "rate_hz");
  } else {
    refuse(file + ": is a calibration of no known layout; known are " + kLayouts);
  }
  read_sigmas(fields, calibration.camera);
  return calibration;
}

Calibration read_calibration(const std::string& path, ImageSize images) {
  return parse_calibration(read_text(path, kMaxYamlBytes, "calibration"), path, images);
}

void require_image_size(const Calibration& calibration, const std::string& file) {
  if (calibration.camera.width == 0) {
    refuse(file +
           ": does not say the size of the images, which is known only where it is read with a folder of images; " +
           (calibration.form == std::string("kitti") ? "write its numbers into a calib.yaml with width and height"
                                                     : "add Camera.width and Camera.height"));
  }
}

}  // namespace pf::sequence
