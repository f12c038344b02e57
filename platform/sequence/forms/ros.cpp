/// ROS camera_info: the file of camera_calibration, and the message as rostopic and ros2 topic print it.
#include <cmath>

#include "form.h"
#include "lens.h"

namespace pf::sequence {

namespace {

/// The names of the same things in the file and in the messages of ROS 1 and 2.
struct Names {
  const char *width, *height, *K, *D, *R, *P;
};
constexpr Names kFile{"image_width",          "image_height",     "camera_matrix", "distortion_coefficients",
                      "rectification_matrix", "projection_matrix"};
constexpr Names kRos1{"width", "height", "K", "D", "R", "P"};
constexpr Names kRos2{"width", "height", "k", "d", "r", "p"};

void require_no_binning(const Fields& fields) {
  for (const char* key : {"binning_x", "binning_y"}) {
    const double binning = fields.number_or(key, 0.0);
    if (binning != 0.0 && binning != 1.0) {
      fields.refuse_field(key, "is " + format_number(binning) +
                                   ": the images are smaller than those that the numbers are of; calibrate the smaller "
                                   "images, which have 1 here");
    }
  }
}

/// A region of interest, in pixels of the full image; all zeros is the full image.
void apply_roi(const Fields& fields, Calibration& calibration) {
  if (!fields.has("roi")) {
    return;
  }
  const Fields roi = fields.below("roi");
  roi.check_keys({{"x_offset", "y_offset", "width", "height", "do_rectify"}, {}}, calibration.notes);
  const double x = roi.number_or("x_offset", 0.0), y = roi.number_or("y_offset", 0.0);
  const int width = roi.has("width") ? roi.integer("width") : 0, height = roi.has("height") ? roi.integer("height") : 0;
  pf_camera_t& camera = calibration.camera;
  if (width == 0 && height == 0 && x == 0.0 && y == 0.0) {
    return;
  }
  if (!(width > 0 && height > 0 && x >= 0.0 && y >= 0.0 && x + width <= camera.width && y + height <= camera.height)) {
    fields.refuse_field("roi", "is no part of the image: it needs x_offset, y_offset, width and height inside of " +
                                   std::to_string(camera.width) + " x " + std::to_string(camera.height));
  }
  if (width == camera.width && height == camera.height) {
    return;
  }
  camera.cx -= x;
  camera.cy -= y;
  camera.width = width;
  camera.height = height;
  calibration.notes.push_back(fields.file() + ": the images are the roi of " + std::to_string(width) + " x " +
                              std::to_string(height) + " at " + format_number(x) + ", " + format_number(y) +
                              ", and the principal point is relative to it");
}

/// K and D are of the images as the camera gives them; R and P of rectified ones, and a note is due where that makes a difference.
void compare_rectified(const Fields& fields, const Names& names, const std::vector<double>& K,
                       std::vector<std::string>& notes) {
  const auto differs = [](double a, double b) { return std::fabs(a - b) > 1e-6 * (1.0 + std::fabs(b)); };
  bool rotated = false, other = false;
  std::string fx;
  if (fields.has(names.R)) {
    const std::vector<double> R = fields.matrix(names.R, 3, 3);
    bool empty = true;
    for (size_t i = 0; i < 9; ++i) {
      rotated = rotated || differs(R[i], i % 4 == 0 ? 1.0 : 0.0);
      empty = empty && R[i] == 0.0;
    }
    rotated = rotated && !empty;
  }
  if (fields.has(names.P)) {
    const std::vector<double> P = fields.matrix(names.P, 3, 4);
    other = P[0] != 0.0 && (differs(P[0], K[0]) || differs(P[5], K[4]) || differs(P[2], K[2]) || differs(P[6], K[5]));
    fx = " (fx " + format_number(P[0]) + " in place of " + format_number(K[0]) + ")";
  }
  if (rotated || other) {
    const std::string what = std::string("'") + (rotated ? names.R : names.P) + "'";
    notes.push_back(fields.file() +
                    ": the numbers are those of the images as the camera gives them; for rectified ones, which " +
                    what + " describes, they would be others" + (other ? fx : ""));
  }
}

void read_names(const Fields& fields, const Names& names, Calibration& calibration) {
  require_no_binning(fields);
  pf_camera_t& camera = calibration.camera;
  camera.width = fields.integer(names.width);
  camera.height = fields.integer(names.height);
  const std::vector<double> K = fields.matrix(names.K, 3, 3);
  const std::string K_name = std::string(names.K) + (fields.is_map(names.K) ? ".data" : "");
  const std::string D_name = std::string(names.D) + (fields.is_map(names.D) ? ".data" : "");
  set_pinhole(pinhole_of(fields, K_name, K), camera);
  const std::vector<double> D = fields.has(names.D) ? fields.vector(names.D, 14) : std::vector<double>();
  set_distortion(fields, "distortion_model", D_name, fields.text("distortion_model"), D, camera);
  check_lens(fields, {names.width, names.height, K_name, K_name, K_name, K_name, D_name}, camera);
  compare_rectified(fields, names, K, calibration.notes);
  apply_roi(fields, calibration);
  check_lens(fields, {"roi", "roi", K_name, K_name, "roi", "roi", D_name}, camera);
}

Fields::Known known_names(const Names& names) {
  return known_fields({names.width, names.height, names.K, names.D, names.R, names.P, "distortion_model", "binning_x",
                       "binning_y", "roi"},
                      {"header", "camera_name", "comment"});
}

bool is_file(const Fields& fields) {
  return fields.has(kFile.K) && fields.has_any({"distortion_model", kFile.R, kFile.P});
}

void read_file(const Fields& fields, const Asked&, Calibration& calibration) {
  fields.check_keys(known_names(kFile), calibration.notes);
  read_names(fields, kFile, calibration);
}

bool is_message(const Fields& fields) { return fields.has("distortion_model") && fields.has_any({kRos1.K, kRos2.K}); }

void read_message(const Fields& fields, const Asked&, Calibration& calibration) {
  const Names& names = fields.has(kRos1.K) ? kRos1 : kRos2;
  fields.check_keys(known_names(names), calibration.notes);
  read_names(fields, names, calibration);
}

}  // namespace

const Form kRosForm{"ros", "ROS camera_info, as a file (camera_matrix:, distortion_model:)", is_file, read_file};
const Form kRosMessageForm{"ros", "or as printed (K:, D: or k:, d:)", is_message, read_message};

}  // namespace pf::sequence
