/// What OpenCV's calibration sample writes, and programs that took it as their model.
#include <algorithm>

#include "form.h"
#include "lens.h"

namespace pf::sequence {

namespace {

const std::vector<std::string> kMatrix{"camera_matrix", "Camera_Matrix", "cameraMatrix", "CameraMatrix", "K"};
const std::vector<std::string> kCoefficients{"distortion_coefficients",
                                             "Distortion_Coefficients",
                                             "dist_coeffs",
                                             "dist_coeff",
                                             "distCoeffs",
                                             "distortionCoefficients",
                                             "D"};
const std::vector<std::string> kWidth{"image_width", "image_Width", "imageWidth"};
const std::vector<std::string> kHeight{"image_height", "image_Height", "imageHeight"};
/// How the calibration was made.
const std::vector<std::string> kBeside{"calibration_*",
                                       "nr_of_*",
                                       "nframes",
                                       "board_*",
                                       "square_*",
                                       "marker_*",
                                       "flags",
                                       "flagValue",
                                       "FixAspectRatio",
                                       "fix_*",
                                       "aspectRatio",
                                       "avg_reprojection_error",
                                       "Avg_Reprojection_Error",
                                       "per_view_*",
                                       "Per_View_*",
                                       "extrinsic_parameters",
                                       "Extrinsic_Parameters",
                                       "image_points",
                                       "Image_points",
                                       "grid_points",
                                       "camera_name",
                                       "rms",
                                       "comment",
                                       "calibration_Time",
                                       "nrOfFrames",
                                       "board_Width",
                                       "board_Height",
                                       "square_Size"};

/// The first of the names that is there, or the first of all.
std::string name_of(const Fields& fields, const std::vector<std::string>& names) {
  const auto found = std::find_if(names.begin(), names.end(), [&](const auto& name) { return fields.has(name); });
  return found == names.end() ? names.front() : *found;
}

bool is_opencv(const Fields& fields) { return fields.has_any(kMatrix); }

/// The coefficients of cv::calibrateCamera or, where the file says so, of cv::fisheye::calibrate.
void read_distortion(const Fields& fields, const std::string& key, pf_camera_t& camera) {
  const std::vector<double> D = fields.has(key) ? fields.vector(key, 14) : std::vector<double>();
  const bool is_fisheye = fields.flag_or("fisheye_model", false);
  const bool straight = std::all_of(D.begin(), D.end(), [](double k) { return k == 0.0; });
  if (D.size() == 4 && !straight && !fields.has("fisheye_model")) {
    fields.refuse_field(
        key,
        "has four coefficients, and nothing says of which model; add fisheye_model: 1 where they are of "
        "cv::fisheye, or fisheye_model: 0");
  }
  if (is_fisheye && D.size() != 4) {
    fields.refuse_field(key, "has " + std::to_string(D.size()) + " coefficients; a fisheye_model has four");
  }
  if (!is_fisheye && !D.empty() && D.size() != 4 && D.size() != 5 && D.size() != 8 && D.size() != 12 &&
      D.size() != 14) {
    fields.refuse_field(key, "has " + std::to_string(D.size()) + " coefficients; OpenCV has 4, 5, 8, 12 or 14");
  }
  const std::string data = key + (fields.is_map(key) ? ".data" : "");
  set_distortion(fields, "fisheye_model", data, is_fisheye ? "fisheye" : "radtan", D, camera);
}

void read_opencv(const Fields& fields, const Asked& asked, Calibration& calibration) {
  const std::string K_key = name_of(fields, kMatrix), D_key = name_of(fields, kCoefficients);
  const std::string width = name_of(fields, kWidth), height = name_of(fields, kHeight);
  fields.check_keys(known_fields({K_key, D_key, width, height, "fisheye_model"}, kBeside), calibration.notes);
  pf_camera_t& camera = calibration.camera;
  const bool has_size = fields.has(width) || fields.has(height);
  camera.width = has_size ? fields.integer(width) : asked.images.width;
  camera.height = has_size ? fields.integer(height) : asked.images.height;
  const std::string K_name = K_key + (fields.is_map(K_key) ? ".data" : "");
  set_pinhole(pinhole_of(fields, K_name, fields.matrix(K_key, 3, 3)), camera);
  read_distortion(fields, D_key, camera);
  calibration.size_hint = "add image_width and image_height";
  if (has_size || camera.width > 0) {
    check_lens(fields, {width, height, K_name, K_name, K_name, K_name, D_key}, camera);
  }
}

}  // namespace

const Form kOpencvForm{"opencv", "OpenCV's (camera_matrix:, distortion_coefficients:, fisheye_model:)", is_opencv,
                       read_opencv};

}  // namespace pf::sequence
