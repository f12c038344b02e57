#ifndef PLANEFOLD_CAPTURE_RECORDER_H
#define PLANEFOLD_CAPTURE_RECORDER_H

#include <planefold/planefold.h>

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "text_file.h"

namespace pf::capture {

/// Frames to a folder in EuRoC layout, by a thread of its own: mav0/cam0/data/TIME.png, data.csv, sensor.yaml, and in
/// tracked.csv the frames that were tracked, where the others were passed over.
///
/// Images are stored, not compressed: the disk is to be the bound, not the processor that the tracker needs.
class Recorder {
 public:
  Recorder() = default;
  ~Recorder() { close(); }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// false: error is one line. A folder that already holds a recording is refused.
  bool open(const std::string& folder, const pf_camera_t& camera, double rate_hz, std::string& error);
  bool is_open() const { return thread_.joinable(); }

  /// Copies the frame and comes back; waits only where the disk is behind by kWaitingBytes.
  void add(const pf_image_t& image);
  void mark_tracked(int64_t t_ns);
  /// true: something could not be written, and error is one line. What follows is not recorded any more.
  bool failed(std::string& error);
  /// Writes what waits and closes the files. false: not everything could be written, and error is one line.
  bool close(std::string* error = nullptr);
  int64_t frames() const { return frames_; }

 private:
  struct Picture {
    int64_t t_ns;
    int32_t width, height;
    std::vector<uint8_t> pixels;
  };
  static constexpr size_t kWaitingBytes = size_t{256} << 20;

  void work();
  void write(const Picture& picture);

  std::filesystem::path camera_folder_;
  TextFile table_, tracked_;
  std::thread thread_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Picture> waiting_;              // under mutex_
  std::vector<std::vector<uint8_t>> spare_;  // under mutex_
  size_t waiting_bytes_ = 0;                 // under mutex_
  bool stop_ = false;                        // under mutex_
  std::string failure_;                      // under mutex_
  int64_t frames_ = 0;                       // of the thread, until it is joined
};

}  // namespace pf::capture

#endif
