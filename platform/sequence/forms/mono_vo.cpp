/// camera.txt of the photometric mono-VO data set and of the programs that read it: a model with its numbers, the size, and two lines on
/// how they cut the image, which change nothing here. Centres below 1 are shares of the size, with the corner of the first pixel at 0, 0.
#include <algorithm>
#include <cmath>

#include "../file.h"
#include "../numbers.h"
#include "form.h"
#include "lens.h"

namespace pf::sequence {

namespace {

constexpr const char *kModel = "mono-VO camera", *kSize = "mono-VO size";
constexpr double kFirstPixel = 0.5;

struct Model {
  const char* name;
  const char* distortion;  ///< name of the library's model
  size_t coefficients;
};

/// The last number of Pinhole is that of its field of view, which is 0.
constexpr Model kModels[] = {{"Pinhole", "none", 1},
                             {"RadTan", "radtan", 4},
                             {"EquiDistant", "equidistant", 4},
                             {"KannalaBrandt", "equidistant", 4}};
constexpr const char* kFov = "FOV";

bool is_model(std::string_view word) {
  return word == kFov ||
         std::any_of(std::begin(kModels), std::end(kModels), [&](const Model& m) { return word == m.name; });
}

bool are_numbers(const std::vector<std::string_view>& words, size_t first) {
  double value = 0.0;
  return std::all_of(words.begin() + static_cast<std::ptrdiff_t>(first), words.end(),
                     [&](std::string_view word) { return parse_double(word, value); });
}

bool is_mono_vo(const Fields& fields) { return fields.has(kModel) && fields.has(kSize) && fields.keys().size() == 2; }

void read_mono_vo(const Fields& fields, const Asked& /*asked*/, Calibration& calibration) {
  const std::string text = fields.text(kModel);
  const size_t blank = text.find(' ');
  const std::string name = text.substr(0, blank);
  const Model* model =
      std::find_if(std::begin(kModels), std::end(kModels), [&](const Model& m) { return name == m.name; });
  const Fields numbers(std::string(kModel) + ": \"" + text.substr(blank + 1) + "\"\n", fields.file());
  std::vector<double> p = numbers.numbers_in_text(kModel);
  const std::vector<double> size = fields.numbers_in_text(kSize);
  if (size.size() != 2) {
    fields.refuse_field(kSize, "must be two whole numbers, width and height");
  }
  const bool is_pinhole = p.size() == 5 && p[4] == 0.0 && (name == kFov || name == "Pinhole");
  if (!is_pinhole && (model == std::end(kModels) || model->coefficients + 4 != p.size() || name == "Pinhole")) {
    fields.refuse_field(
        kModel,
        "is '" + name + "' with " + std::to_string(p.size()) +
            " numbers; known are Pinhole fx fy cx cy 0, RadTan and EquiDistant with eight. Undistort the images, or "
            "calibrate anew");
  }
  pf_camera_t& camera = calibration.camera;
  camera.width = static_cast<int32_t>(size[0]);
  camera.height = static_cast<int32_t>(size[1]);
  if (p[2] < 1.0 && p[3] < 1.0) {
    p[0] *= size[0];
    p[1] *= size[1];
    p[2] = p[2] * size[0] - kFirstPixel;
    p[3] = p[3] * size[1] - kFirstPixel;
  }
  set_pinhole({p[0], p[1], p[2], p[3]}, camera);
  set_distortion(fields, kModel, kModel, is_pinhole ? "none" : model->distortion,
                 is_pinhole ? std::vector<double>() : std::vector<double>(p.begin() + 4, p.end()), camera);
  check_lens(fields, {kSize, kSize, kModel, kModel, kModel, kModel, kModel}, camera);
}

}  // namespace

std::string from_mono_vo(const std::string& text) {
  constexpr size_t kMaxBytes = 4096, kRows = 4, kMost = 1e6;
  const std::vector<Row> rows = text.size() <= kMaxBytes ? split_rows(text) : std::vector<Row>();
  if (rows.size() != kRows || rows[0].words.size() < 5 || rows[1].words.size() != 2) {
    return text;
  }
  const bool named = is_model(rows[0].words[0]);
  int64_t width = 0, height = 0;
  if (!are_numbers(rows[0].words, named ? 1 : 0) || (!named && rows[0].words.size() != 5) ||
      !parse_integer(rows[1].words[0], width) || !parse_integer(rows[1].words[1], height) || width <= 0 ||
      height <= 0 || width > int64_t{kMost} || height > int64_t{kMost}) {
    return text;
  }
  std::string model = named ? "" : kFov;
  for (const std::string_view word : rows[0].words) {
    model += (model.empty() ? "" : " ") + std::string(word);
  }
  return std::string(kModel) + ": \"" + model + "\"\n" + kSize + ": \"" + std::to_string(width) + " " +
         std::to_string(height) + "\"\n";
}

const Form kMonoVoForm{"mono_vo", "mono-VO's camera.txt (Pinhole, RadTan, EquiDistant)", is_mono_vo, read_mono_vo};

}  // namespace pf::sequence
