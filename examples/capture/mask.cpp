#include "mask.h"

#include <planefold_platform/sequence.h>

namespace pf::capture {

bool FrameMask::read(const std::string& file, const SourceInfo& info, pf_config_t& config, std::string& error) {
  path_ = file == "auto" ? info.mask_path : file == "none" ? "" : file;
  if (path_.empty()) {
    return true;
  }
  width_ = config.camera.width;
  height_ = config.camera.height;
  pixels_.resize(static_cast<size_t>(width_) * static_cast<size_t>(height_));
  char message[PF_SEQUENCE_MESSAGE] = "";
  if (pf_read_mask(path_.c_str(), width_, height_, pixels_.data(), message) != 0) {
    error = message;
    return false;
  }
  config.capacity.mask = static_cast<int32_t>(pixels_.size());
  return true;
}

bool FrameMask::set(pf_slam_t* slam, std::string& note, std::string& error) const {
  if (empty()) {
    return true;
  }
  const pf_mask_t mask = {pixels_.data(), width_, height_, width_, 0, nullptr};
  const pf_status_t status = pf_set_mask(slam, &mask);
  if (status == PF_NOTE_UNUSABLE) {
    note += (note.empty() ? "" : "; ") + path_ + ": leaves so little of the images that hardly anything is tracked";
  } else if (status != PF_OK) {
    error = path_ + ": " + (status == PF_ERROR_RANGE ? "ignores the whole image" : pf_status_text(status));
  }
  return status >= PF_OK;
}

}  // namespace pf::capture
