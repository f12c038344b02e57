#include "calibration.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "file.h"
#include "forms/form.h"
#include "forms/lens.h"
#include "refuse.h"
#include "yaml_fields.h"

namespace pf::sequence {

namespace {

/// From the first row to the last [s]; zero where the file says nothing of it.
double read_readout(const Fields& fields) {
  const double readout = fields.number_or("readout_s", 0.0);
  if (!(readout >= 0.0 && readout <= 0.2)) {
    fields.refuse_field("readout_s", "is " + format_number(readout) + "; a rolling shutter takes 0 to 0.2 s");
  }
  return readout;
}

/// Numbers that images as a camera gives them are not likely to have, in one line each.
void note_unlikely(const Fields& fields, Calibration& calibration) {
  constexpr double kUnlikely = 0.1;  ///< of the ratio of fx and fy to 1, and of the centre to the middle in widths
  const pf_camera_t& camera = calibration.camera;
  char text[320];
  if (std::fabs(camera.fx / camera.fy - 1.0) > kUnlikely) {
    std::snprintf(text, sizeof(text),
                  ": fx %.6g and fy %.6g differ by %.1f %%, as where images were scaled to another form or pixels are "
                  "not square; is it the calibration of these images?",
                  camera.fx, camera.fy, 100.0 * std::fabs(camera.fx / camera.fy - 1.0));
    calibration.notes.push_back(fields.file() + text);
  }
  const double most_px = kUnlikely * camera.width;
  const auto is_off = [&](double x, double y) {
    return std::fabs(x - 0.5 * camera.width) > most_px || std::fabs(y - 0.5 * camera.height) > most_px;
  };
  if (is_off(camera.cx, camera.cy)) {
    std::snprintf(
        text, sizeof(text),
        ": the principal point %.6g, %.6g is far from the middle of %d x %d px, as in images that were cut out "
        "of larger ones; %s",
        camera.cx, camera.cy, camera.width, camera.height,
        is_off(camera.cy, camera.cx) ? "is it the calibration of these images?" : "are cx and cy exchanged?");
    calibration.notes.push_back(fields.file() + text);
  }
}

/// How well the numbers are known. Where the file says nothing, what is typical: focal lengths within 1 %, one against the other within
/// 0.1 %, the centre within 1 % of the width; distortion as exact, or, where none is named, k1 within 0.05.
void read_sigmas(const Fields& fields, pf_camera_t& camera) {
  const auto sigma = [&](const char* key, double otherwise, double lowest, double highest) {
    const double value = fields.number_or(key, otherwise);
    if (!(value >= lowest && value <= highest)) {
      fields.refuse_field(key, "is " + format_number(value) + "; a standard deviation of " + format_number(lowest) +
                                   " to " + format_number(highest) + " is possible");
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
                          "has " + format_number(values[i]) + "; standard deviations of 0 (exact) to 1 are possible");
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

const Form* form_of(const Fields& fields) {
  for (const Form* form : all_forms()) {
    if (form->is(fields)) {
      return form;
    }
  }
  return nullptr;
}

std::string known_forms() {
  std::string labels;
  for (const Form* form : all_forms()) {
    labels += (labels.empty() ? "" : ", ") + std::string(form->label);
  }
  return labels;
}

std::vector<Fields> documents_of(const std::string& text, const std::string& file) {
  try {
    return Fields::documents(from_mono_vo(from_eth3d(from_colmap(text))), file);
  } catch (const NoFields& error) {
    refuse(error.what() + std::string(" Known are ") + known_forms());
  }
}

/// Refuses settings of a program that name the file of the calibration: VINS-Fusion's cam0_calib, OpenVINS' relative_config_imucam.
void refuse_settings(const Fields& fields) {
  for (const std::string& key : fields.keys()) {
    const std::string name = fields.is_scalar(key) ? fields.text(key) : "";
    const fs::path beside = fs::path(fields.file()).parent_path() / name;
    const std::string extension = fs::path(name).extension().string();
    if ((extension == ".yaml" || extension == ".yml") &&
        (key.find("calib") != key.npos || key.find("cam") != key.npos)) {
      refuse(fields.file() + ": holds the settings of a program, and names its calibration in '" + key + "'; " +
             (is_file(beside) ? "give that: " + beside.string() : "give that: " + name + ", which is not beside it"));
    }
  }
}

Calibration read_fields(const Fields& fields, const Asked& asked) {
  const Form* form = form_of(fields);
  if (form == nullptr) {
    refuse_settings(fields);
    refuse(fields.file() + ": is a calibration of no known layout; known are " + known_forms());
  }
  Calibration calibration{};
  calibration.form = form->name;
  form->read(fields, asked, calibration);
  const Fields settings = calibration.section.empty() ? fields : fields.with_those_below(calibration.section);
  calibration.camera.readout_s = read_readout(settings);
  calibration.camera.timestamps = read_timestamps(settings);
  read_sigmas(settings, calibration.camera);
  if (calibration.camera.width > 0) {
    note_unlikely(fields, calibration);
  }
  if (!asked.camera.empty() && calibration.camera_name.empty()) {
    refuse(fields.file() + ": holds one camera, which has no name to choose it by; leave --camera away");
  }
  return calibration;
}

/// Whether a further document says the same camera again.
bool repeats(const Fields& fields, const Asked& asked, const pf_camera_t& camera) {
  try {
    return is_same_lens(read_fields(fields, asked).camera, camera);
  } catch (const ReadError&) {
    return false;
  }
}

}  // namespace

bool is_same_lens(const pf_camera_t& a, const pf_camera_t& b) {
  const bool sizes = a.width == 0 || b.width == 0 || (a.width == b.width && a.height == b.height);
  return sizes && a.model == b.model && a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy &&
         std::equal(std::begin(a.distortion), std::end(a.distortion), b.distortion);
}

double read_rate(const Fields& fields, const char* key) {
  const double rate = fields.number_or(key, 0.0);
  if (rate != 0.0 && !(rate >= 0.1 && rate <= 10000.0)) {
    fields.refuse_field(key, "is " + format_number(rate) + "; 0.1 to 10000 frames per second are possible");
  }
  return rate;
}

Calibration parse_calibration(const std::string& text, const std::string& file, const Asked& asked) {
  const std::vector<Fields> documents = documents_of(text, file);
  Calibration calibration{};
  read_with_hints(documents.front(), [&](const Fields& fields) { calibration = read_fields(fields, asked); });
  // A stream of messages repeats the camera.
  for (size_t i = 1; i < documents.size(); ++i) {
    if (!repeats(documents[i], asked, calibration.camera)) {
      refuse(file + ": holds several documents, and number " + std::to_string(i + 1) +
             " has not the camera of the first; keep one in a file");
    }
  }
  return calibration;
}

bool is_calibration(const std::string& text) {
  try {
    return form_of(Fields(from_colmap(text), "")) != nullptr;
  } catch (const std::exception&) {
    return false;
  }
}

Calibration read_calibration(const std::string& path, const Asked& asked) {
  return parse_calibration(read_text(path, kMaxYamlBytes, "calibration"), path, asked);
}

void require_image_size(const Calibration& calibration, const std::string& file) {
  if (calibration.camera.width == 0) {
    refuse(file + ": does not say the size of the images, which is known only where it is read with a folder of " +
           "images; " + calibration.size_hint);
  }
}

}  // namespace pf::sequence
