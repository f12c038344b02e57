/// cameras.txt of COLMAP. The centre of its first pixel is 0.5, 0.5, where ours is 0, 0.
#include <algorithm>
#include <cctype>
#include <cmath>

#include "../file.h"
#include "../numbers.h"
#include "form.h"
#include "lens.h"

namespace pf::sequence {

namespace {

constexpr const char* kBefore = "camera ";
constexpr double kFirstPixel = 0.5;

/// CAMERA_ID MODEL WIDTH HEIGHT and at least a focal length.
bool is_row(const Row& row) {
  int64_t number = 0;
  if (row.words.size() < 5 || !parse_integer(row.words[0], number) || !parse_integer(row.words[2], number) ||
      !parse_integer(row.words[3], number)) {
    return false;
  }
  const std::string_view model = row.words[1];
  return std::isupper(static_cast<unsigned char>(model[0])) != 0 &&
         std::all_of(model.begin(), model.end(),
                     [](unsigned char c) { return std::isupper(c) != 0 || std::isdigit(c) != 0 || c == '_'; });
}

struct Model {
  const char* name;
  size_t focal_lengths;
  const char* distortion;  ///< name of the library's model
  size_t coefficients;
};

constexpr Model kModels[] = {{"SIMPLE_PINHOLE", 1, "none", 0},  {"PINHOLE", 2, "none", 0},
                             {"SIMPLE_RADIAL", 1, "radtan", 1}, {"RADIAL", 1, "radtan", 2},
                             {"OPENCV", 2, "radtan", 4},        {"OPENCV_FISHEYE", 2, "equidistant", 4}};

const Model& model_of(const Fields& fields, const std::string& key, std::string_view name) {
  std::string names;
  for (const Model& model : kModels) {
    if (name == model.name) {
      return model;
    }
    names += (names.empty() ? "" : ", ") + std::string(model.name);
  }
  fields.refuse_field(key, "is '" + std::string(name) + "'; known are " + names);
}

bool is_colmap(const Fields& fields) {
  const std::vector<std::string> keys = fields.keys();
  return !keys.empty() && keys.front().rfind(kBefore, 0) == 0 &&
         keys.front().find_first_not_of("0123456789", std::string(kBefore).size()) == std::string::npos;
}

std::vector<NamedCamera> cameras_of(const Fields& fields) {
  std::vector<NamedCamera> cameras;
  for (const std::string& key : fields.keys()) {
    cameras.push_back({key, {}});
  }
  return cameras;
}

void read_colmap(const Fields& fields, const Asked& asked, Calibration& calibration) {
  fields.check_keys({fields.keys(), {}}, calibration.notes);
  const std::vector<NamedCamera> cameras = cameras_of(fields);
  const std::string key = cameras[choose_camera(fields, cameras, asked, false, calibration.notes)].name;
  calibration.camera_name = key;
  const std::string text = fields.text(key);
  const std::vector<Row> rows = split_rows(text);
  if (rows.size() != 1 || rows[0].words.size() < 3) {
    fields.refuse_field(key, "must be CAMERA_ID, MODEL, WIDTH, HEIGHT and the parameters");
  }
  const std::vector<std::string_view>& words = rows[0].words;
  const Model& model = model_of(fields, key, words[0]);
  std::vector<double> values;
  for (size_t i = 1; i < words.size(); ++i) {
    double value = 0.0;
    if (!parse_double(words[i], value) || !(value > -1e6 && value < 1e6)) {
      fields.refuse_field(key, "has '" + std::string(words[i]) + "' where a number is expected");
    }
    values.push_back(value);
  }
  const size_t parameters = model.focal_lengths + 2 + model.coefficients;
  if (values.size() != parameters + 2) {
    fields.refuse_field(key, "has " + std::to_string(values.size() - 2) + " parameters; " + model.name + " has " +
                                 std::to_string(parameters));
  }
  if (values[0] != std::floor(values[0]) || values[1] != std::floor(values[1])) {
    fields.refuse_field(key, "must have whole numbers as width and height");
  }
  pf_camera_t& camera = calibration.camera;
  camera.width = static_cast<int32_t>(values[0]);
  camera.height = static_cast<int32_t>(values[1]);
  const double* p = values.data() + 2;
  const double* centre = p + model.focal_lengths;
  set_pinhole({p[0], p[model.focal_lengths - 1], centre[0] - kFirstPixel, centre[1] - kFirstPixel}, camera);
  std::vector<double> coefficients(centre + 2, centre + 2 + model.coefficients);
  if (model.distortion == std::string("radtan")) {
    coefficients.resize(5, 0.0);
  }
  set_distortion(fields, key, key, model.distortion, coefficients, camera);
  check_lens(fields, {key, key, key, key, key, key, key}, camera);
}

}  // namespace

std::string from_colmap(const std::string& text) {
  const std::vector<Row> rows = text.size() <= kMaxYamlBytes ? split_rows(text) : std::vector<Row>();
  if (rows.empty() || !is_row(rows.front())) {
    return text;
  }
  std::string yaml;
  for (const Row& row : rows) {
    yaml += kBefore + std::string(row.words[0]) + ": \"";
    for (size_t i = 1; i < row.words.size(); ++i) {
      yaml += (i > 1 ? " " : "") + std::string(row.words[i]);
    }
    yaml += "\"\n";
  }
  return yaml;
}

const Form kColmapForm{"colmap", "COLMAP's cameras.txt", is_colmap, read_colmap};

}  // namespace pf::sequence
