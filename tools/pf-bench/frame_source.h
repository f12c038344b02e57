#pragma once

#include <planefold/planefold.h>

#include <string>
#include <vector>

#include "../lib/calibration_options.h"

namespace bench {

/// A whole sequence, decoded into memory.
struct Frames {
  std::string name;
  pf_camera_t camera{};
  std::vector<int64_t> t_ns;
  std::vector<std::vector<uint8_t>> pixels;  ///< width * height each, without padding
  bool has_target = false;
  pf_target_t target{};
  bool has_pose = false;
  pf_pose_t pose{};                    ///< of the first frame
  std::vector<pf_wall_prior_t> walls;  ///< known beforehand, in the frame of that pose or target
  std::string start;                   ///< "auto", or what it starts from

  pf_image_t image(size_t index) const {
    return {pixels[index].data(), camera.width, camera.height, camera.width, t_ns[index]};
  }
};

/// Read video:FILE, images:DIR, euroc:DIR, tum:DIR or sim:NAME. start: auto, pose:FILE, target:FILE, rectangle:WxH, or ""
/// for the target.yaml that lies beside the images, and auto where there is none. false: message is one line.
bool load_frames(const std::string& source, const std::string& start, const pf::tools::CalibrationOptions& calibration,
                 int limit, Frames& frames, std::string& message);

/// Read the walls of a plan. false: message is one line.
bool load_walls(const std::string& file, Frames& frames, std::string& message);

/// The sequences under a folder, as images:DIR; sim:desk where there are none.
std::vector<std::string> default_sources(const char* folder);

}  // namespace bench
