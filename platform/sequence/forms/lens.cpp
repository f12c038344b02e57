#include "lens.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pf::sequence {

namespace {

struct Model {
  const char* name;
  pf_camera_model_t model;
  size_t fewest, most;  ///< distortion coefficients, of which those behind the library's own must be zero
};

/// Names that Kalibr, EuRoC, ROS, OpenCV and the plain form give to the models.
constexpr Model kModels[] = {
    {"none", PF_CAMERA_PINHOLE, 0, 0},
    {"radtan", PF_CAMERA_RADTAN, 4, 5},
    {"radial-tangential", PF_CAMERA_RADTAN, 4, 5},
    {"plumb_bob", PF_CAMERA_RADTAN, 4, 5},
    {"rational_polynomial", PF_CAMERA_RADTAN, 5, 14},
    {"equidistant", PF_CAMERA_EQUIDISTANT, 4, 4},
    {"fisheye", PF_CAMERA_EQUIDISTANT, 4, 4},
    {"harris_division", PF_CAMERA_DIVISION, 1, 1},
    {"division", PF_CAMERA_DIVISION, 1, 1},
};

constexpr size_t kRadtanCoefficients = 5;

}  // namespace

std::string format_number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%g", value);
  return text;
}

void set_pinhole(const Pinhole& pinhole, pf_camera_t& camera) {
  camera.fx = pinhole.fx;
  camera.fy = pinhole.fy;
  camera.cx = pinhole.cx;
  camera.cy = pinhole.cy;
}

Pinhole pinhole_of(const Fields& fields, const std::string& key, const std::vector<double>& K) {
  if (std::all_of(K.begin(), K.end(), [](double value) { return value == 0.0; })) {
    fields.refuse_field(key, "is all zeros: the camera was not calibrated");
  }
  if (K[1] != 0.0 || K[3] != 0.0 || K[6] != 0.0 || K[7] != 0.0 || K[8] != 1.0) {
    fields.refuse_field(key, "must have the form fx 0 cx, 0 fy cy, 0 0 1 (no skew)");
  }
  return {K[0], K[4], K[2], K[5]};
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
  const size_t most = std::min(model->most, model->model == PF_CAMERA_RADTAN ? kRadtanCoefficients : model->most);
  if (used > most) {
    const bool higher = model->model == PF_CAMERA_RADTAN;
    fields.refuse_field(list_key, "has " + std::to_string(used) + " coefficients; '" + name + "' can use " +
                                      std::to_string(most) +
                                      (higher ? " (k1, k2, p1, p2, k3), and those behind must be zero" : ""));
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
      fields.refuse_field(list_key, "has the absurd coefficient " + format_number(coefficients[i]));
    }
    camera.distortion[i] = coefficients[i];
  }
}

void check_lens(const Fields& fields, const LensNames& names, const pf_camera_t& camera) {
  const auto side = [&](const std::string& key, int value) {
    if (value < 32 || value > 4096) {
      fields.refuse_field(key, "is " + std::to_string(value) + " px; 32 to 4096 are possible");
    }
  };
  side(names.width, camera.width);
  side(names.height, camera.height);
  const auto focal = [&](const std::string& key, double value, int size) {
    if (!(value > 0.05 * size) || value > 50.0 * size) {
      fields.refuse_field(key, "says a focal length of " + format_number(value) +
                                   " px, which is absurd for an image of " + std::to_string(size) + " px");
    }
  };
  focal(names.fx, camera.fx, camera.width);
  focal(names.fy, camera.fy, camera.height);
  if (camera.fx > 2.0 * camera.fy || camera.fy > 2.0 * camera.fx) {
    fields.refuse_field(names.fy, "makes pixels more than twice as high as wide or the reverse (fx " +
                                      format_number(camera.fx) + ", fy " + format_number(camera.fy) + ")");
  }
  const auto centre = [&](const std::string& key, double value, int size) {
    if (!(value >= 0.0) || value > size - 1.0) {
      fields.refuse_field(key, "says a principal point at " + format_number(value) + " px, outside of the image of " +
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
      fields.refuse_field(names.distortion, "is too strong (" + format_number(camera.distortion[0]) +
                                                " 1/px^2): the image's corners would have no ray");
    }
  }
}

}  // namespace pf::sequence
