#ifndef PLANEFOLD_CAPTURE_LIVE_SOURCE_H
#define PLANEFOLD_CAPTURE_LIVE_SOURCE_H

#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "camera.h"
#include "histogram.h"
#include "notices.h"
#include "recorder.h"
#include "source.h"

namespace pf::capture {

/// A camera as a source. A thread of its own takes the frames, so that tracking never holds capture up:
///
///   camera -> capture thread -> one place for the newest frame -> read()
///                  |
///                  +-> recorder
///
/// A frame that still lies in the place when the next one comes is passed over and counted. With --every-frame there is a queue of
/// copies instead, and only when kQueueBytes of them wait does the camera lose frames, which it counts.
class LiveSource : public Source {
 public:
  LiveSource(std::unique_ptr<Camera> camera, const Options& options, SourceInfo info);
  ~LiveSource() override;

  const SourceInfo& info() const override { return info_; }
  Read read(int64_t index, pf_image_t& image, std::string& error) override;
  std::string name(int64_t) const override;
  bool truth(pf_pose_t& pose) override;
  bool target(pf_target_t& target) const override { return camera_->target(target); }
  bool is_live() const override { return true; }
  bool record_to(Recorder& recorder) override;
  void pushed() override;
  bool take_notice(std::string& notice) override { return notices_.take(notice); }
  std::string report() override;
  std::string finish() override;

 private:
  static constexpr size_t kQueueBytes = size_t{256} << 20;

  struct Waiting {
    CameraFrame frame;
    std::vector<uint8_t> copy;  ///< of the pixels, with --every-frame
  };

  void stop();
  void capture();
  void deliver(const CameraFrame& frame);
  void take_back();
  bool wait_for_return(const std::string& message);

  std::unique_ptr<Camera> camera_;
  SourceInfo info_;
  bool every_frame_;
  int priority_, processor_;
  Recorder* recorder_ = nullptr;
  std::thread thread_;
  std::atomic<bool> stop_{false};

  std::mutex mutex_;  ///< of what follows, up to the blank line
  std::condition_variable changed_;
  std::deque<Waiting> waiting_;
  std::deque<CameraFrame> returned_;
  size_t waiting_bytes_ = 0;
  bool ended_ = false;
  std::string failure_;
  Notices notices_;
  int64_t captured_ = 0, passed_over_ = 0, last_t_ns_ = 0;
  Histogram interval_ms_;
  int outstanding_ = 0;

  Waiting current_;  ///< of the reading thread, as what follows
  bool has_current_ = false;
  Histogram wait_ms_, latency_ms_;
};

}  // namespace pf::capture

#endif
