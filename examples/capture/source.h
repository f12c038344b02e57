#ifndef PLANEFOLD_CAPTURE_SOURCE_H
#define PLANEFOLD_CAPTURE_SOURCE_H

#include <planefold/planefold.h>

#include <cstdint>
#include <memory>
#include <string>

#include "options.h"

namespace pf::capture {

enum class Read { kDone, kEnd, kFailed };

struct SourceInfo {
  pf_camera_t camera{};
  int64_t count = 0;  ///< at most; a simulated camera that drops frames gives fewer
  double rate_hz = 30.0;
  std::string truth_path;  ///< a trajectory that lies beside the source; "" where there is none
  std::string warning;
  bool knows_truth = false;  ///< by truth() for every frame that was read
};

/// Frames by number: a folder or a simulated scene.
class Source {
 public:
  virtual ~Source() = default;
  virtual const SourceInfo& info() const = 0;
  /// Frames are read in the order of their numbers. kFailed: error is one line. The pixels are valid until the next call.
  virtual Read read(int64_t index, pf_image_t& image, std::string& error) = 0;
  /// File or name of a frame, for messages.
  virtual std::string name(int64_t index) const = 0;
  /// The true pose of the frame that was read last.
  virtual bool truth(pf_pose_t&) { return false; }
  /// The target that the source itself knows, for --start target.
  virtual bool target(pf_target_t&) const { return false; }
};

/// null: error is one line.
std::unique_ptr<Source> open_source(const Options& options, std::string& error);

std::unique_ptr<Source> open_sim_source(const Options& options, std::string& error);

}  // namespace pf::capture

#endif
