#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "../lib/calibration_options.h"
#include "planefold/planefold.h"

namespace pfsim {

/// Real frames in memory, so that they can be shown in any order.
class Film {
 public:
  /// Reads all frames of a source of platform_sequence. False, with one line that says why, when that is not possible.
  bool open(const std::string& source, const pf::tools::CalibrationOptions& calibration, std::string* error);

  const pf_camera_t& camera() const { return camera_; }
  int frames() const { return static_cast<int>(times_ns_.size()); }
  std::int64_t t_ns(int frame) const { return times_ns_[static_cast<std::size_t>(frame)]; }
  std::int64_t interval_ns() const { return interval_ns_; }
  /// Picture of a frame; black for -1.
  const std::uint8_t* pixels(int frame) const;

 private:
  pf_camera_t camera_{};
  std::vector<std::int64_t> times_ns_;
  std::vector<std::uint8_t> pixels_;  // behind the frames, a black one
  std::int64_t interval_ns_ = 0;
};

/// What --start says: auto, or target:FILE. False, with one line that says why, where it says something else.
bool read_start(const std::string& start, bool* has_target, pf_target_t* target, std::string* error);

/// The default config with the film's camera. False, likewise, where its calibration cannot be used.
bool config_for(const Film& film, pf_config_t* config, std::string* error);

}  // namespace pfsim
