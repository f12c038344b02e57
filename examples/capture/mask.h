#ifndef PLANEFOLD_CAPTURE_MASK_H
#define PLANEFOLD_CAPTURE_MASK_H

#include <planefold/planefold.h>

#include <string>
#include <vector>

#include "source.h"

namespace pf::capture {

/// What the frames show that is not the scene, from a PNG.
class FrameMask {
 public:
  /// file: auto (the one beside the frames, if any), none, or a path. Makes room for it in the config. false: error is one line.
  bool read(const std::string& file, const SourceInfo& info, pf_config_t& config, std::string& error);
  bool empty() const { return pixels_.empty(); }
  /// Masks all frames from now on, where there is a mask. note: a line for the user, added to what it holds. false: error is one line.
  bool set(pf_slam_t* slam, std::string& note, std::string& error) const;

 private:
  std::vector<uint8_t> pixels_;
  int32_t width_ = 0, height_ = 0;
  std::string path_;
};

}  // namespace pf::capture

#endif
