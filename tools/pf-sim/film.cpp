#include "film.h"

#include <planefold_platform/sequence.h>

#include <memory>

namespace pfsim {
namespace {

struct CloseSequence {
  void operator()(pf_sequence_t* s) const { pf_close_sequence(s); }
};

}  // namespace

bool Film::open(const std::string& source, const pf::tools::CalibrationOptions& calibration, std::string* error) {
  char message[PF_SEQUENCE_MESSAGE] = "";
  pf_sequence_t* opened = nullptr;
  if (pf_open_sequence_of(source.c_str(), calibration.file_or_null(), calibration.camera.c_str(), &opened, message) !=
      0) {
    *error = message;
    return false;
  }
  const std::unique_ptr<pf_sequence_t, CloseSequence> sequence(opened);
  pf_sequence_info_t info;
  pf_get_sequence_info(opened, &info);
  pf::tools::print_notes("pf-sim", info.warning);
  camera_ = info.camera;
  interval_ns_ = static_cast<std::int64_t>(1e9 / info.rate_hz);
  const std::size_t size = static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(camera_.height);
  pixels_.reserve(size * static_cast<std::size_t>(info.count + 1));
  for (std::int64_t i = 0; i < info.count; ++i) {
    pf_image_t image;
    if (pf_read_sequence_frame(opened, i, &image, message) != 0) {
      *error = message;
      return false;
    }
    times_ns_.push_back(image.t_ns);
    for (int row = 0; row < image.height; ++row) {
      const std::uint8_t* from = image.pixels + static_cast<std::ptrdiff_t>(row) * image.stride;
      pixels_.insert(pixels_.end(), from, from + image.width);
    }
  }
  pixels_.resize(pixels_.size() + size, 0);
  return true;
}

const std::uint8_t* Film::pixels(int frame) const {
  const std::size_t size = static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(camera_.height);
  return pixels_.data() + size * static_cast<std::size_t>(frame < 0 ? frames() : frame);
}

bool read_start(const std::string& start, bool* has_target, pf_target_t* target, std::string* error) {
  *has_target = start.rfind("target:", 0) == 0;
  char message[PF_SEQUENCE_MESSAGE] = "";
  if (*has_target && pf_read_target(start.c_str() + 7, target, message) != 0) {
    *error = message;
    return false;
  }
  *error = "--start " + start + ": write auto or target:FILE";
  return *has_target || start == "auto";
}

bool config_for(const Film& film, pf_config_t* config, std::string* error) {
  pf_config_default(config);
  config->camera = film.camera();
  const char* field = nullptr;
  if (pf_config_check(config, &field) == PF_OK) return true;
  *error = std::string("the calibration cannot be used: ") + field + " is out of its range";
  return false;
}

}  // namespace pfsim
