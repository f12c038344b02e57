#include "live_source.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "realtime.h"
#include "steady.h"

namespace pf::capture {

namespace {

constexpr int kWaitMs = 50;                ///< how long a stop may take to be noticed
constexpr int64_t kSilentNs = 2000000000;  ///< without a frame: worth a note
constexpr int64_t kMuteNs = 10000000000;   ///< without the very first frame: no use in waiting

double rounded(double value) { return std::round(1e3 * value) * 1e-3; }

nlohmann::ordered_json spread(const Histogram& values) {
  return {{"min", rounded(values.smallest())},
          {"median", rounded(values.quantile(0.5))},
          {"p95", rounded(values.quantile(0.95))},
          {"max", rounded(values.largest())}};
}

}  // namespace

LiveSource::LiveSource(std::unique_ptr<Camera> camera, const Options& options, SourceInfo info)
    : camera_(std::move(camera)),
      info_(std::move(info)),
      every_frame_(options.every_frame),
      priority_(options.priority),
      processor_(options.capture_processor) {}

LiveSource::~LiveSource() { stop(); }

void LiveSource::stop() {
  stop_ = true;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    changed_.notify_all();
  }
  if (thread_.joinable()) {
    thread_.join();
  }
}

bool LiveSource::record_to(Recorder& recorder) {
  recorder_ = &recorder;
  return true;
}

std::string LiveSource::name(int64_t) const {
  return "frame " + std::to_string(current_.frame.number) + " of " + info_.device;
}

Read LiveSource::read(int64_t, pf_image_t& image, std::string& error) {
  if (!thread_.joinable()) {
    if (!camera_->start(error)) {
      return Read::kFailed;
    }
    thread_ = std::thread([this] { capture(); });
  }
  std::unique_lock<std::mutex> lock(mutex_);
  if (has_current_) {
    if (current_.copy.empty()) {
      returned_.push_back(current_.frame);
    }
    has_current_ = false;
  }
  changed_.wait_for(lock, std::chrono::milliseconds(kWaitMs),
                    [&] { return !waiting_.empty() || ended_ || !failure_.empty(); });
  if (waiting_.empty()) {
    error = failure_;
    return !failure_.empty() ? Read::kFailed : ended_ ? Read::kEnd : Read::kNothing;
  }
  current_ = std::move(waiting_.front());
  waiting_.pop_front();
  waiting_bytes_ -= current_.copy.size();
  has_current_ = true;
  changed_.notify_all();
  if (!current_.copy.empty()) {
    current_.frame.image.pixels = current_.copy.data();
  }
  image = current_.frame.image;
  wait_ms_.add(1e-6 * static_cast<double>(steady_ns() - current_.frame.arrived_ns));
  return Read::kDone;
}

bool LiveSource::truth(pf_pose_t& pose) {
  pose = current_.frame.truth;
  return current_.frame.has_truth;
}

void LiveSource::pushed() { latency_ms_.add(1e-6 * static_cast<double>(steady_ns() - current_.frame.arrived_ns)); }

/// The capture thread.
void LiveSource::capture() {
  if (!place_thread(processor_, priority_ > 0 ? priority_ + 1 : 0)) {
    notices_.add(
        "the capture thread keeps its usual place: processor or priority were refused (root, or RLIMIT_RTPRIO)");
  }
  int64_t last_ns = steady_ns();
  bool silent = false;
  while (!stop_) {
    take_back();
    CameraFrame frame;
    std::string message;
    switch (camera_->next(kWaitMs, frame, message)) {
      case CameraRead::kFrame:
        last_ns = steady_ns();
        silent = false;
        deliver(frame);
        break;
      case CameraRead::kNothing:
        if (!silent && steady_ns() - last_ns > kSilentNs) {
          silent = true;
          notices_.add(info_.device + ": no frame for 2 s; the camera is there, but gives nothing");
        }
        if (captured_ == 0 && steady_ns() - last_ns > kMuteNs) {
          message = info_.device + ": not one frame in 10 s; does the camera work in another program?";
          const std::lock_guard<std::mutex> lock(mutex_);
          failure_ = message;
          changed_.notify_all();
          return;
        }
        break;
      case CameraRead::kGone:
        if (!wait_for_return(message)) {
          return;
        }
        last_ns = steady_ns();
        break;
      case CameraRead::kEnd:
      case CameraRead::kFailed: {
        const std::lock_guard<std::mutex> lock(mutex_);
        ended_ = message.empty();
        failure_ = message;
        changed_.notify_all();
        return;
      }
    }
  }
}

/// Gives the camera its buffers back.
void LiveSource::take_back() {
  std::deque<CameraFrame> returned;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    returned.swap(returned_);
    outstanding_ -= static_cast<int>(returned.size());
  }
  for (const CameraFrame& frame : returned) {
    camera_->release(frame);
  }
}

void LiveSource::deliver(const CameraFrame& frame) {
  if (recorder_ != nullptr && recorder_->is_open()) {
    recorder_->add(frame.image);
  }
  Waiting next{frame, {}};
  if (every_frame_) {
    const pf_image_t& image = frame.image;
    next.copy.resize(static_cast<size_t>(image.width) * static_cast<size_t>(image.height));
    for (int32_t y = 0; y < image.height; ++y) {
      std::copy_n(image.pixels + static_cast<ptrdiff_t>(y) * image.stride, image.width,
                  next.copy.begin() + static_cast<ptrdiff_t>(y) * image.width);
    }
    next.frame.image.stride = image.width;
    camera_->release(frame);
  }
  std::unique_lock<std::mutex> lock(mutex_);
  if (captured_++ > 0) {
    interval_ms_.add(1e-6 * static_cast<double>(frame.image.t_ns - last_t_ns_));
  }
  last_t_ns_ = frame.image.t_ns;
  if (every_frame_) {
    changed_.wait(lock, [&] { return stop_ || waiting_bytes_ < kQueueBytes; });
    waiting_bytes_ += next.copy.size();
  } else {
    for (const Waiting& late : waiting_) {
      returned_.push_back(late.frame);
      ++passed_over_;
    }
    waiting_.clear();
    ++outstanding_;
  }
  waiting_.push_back(std::move(next));
  changed_.notify_all();
}

/// false: the run was stopped meanwhile.
bool LiveSource::wait_for_return(const std::string& message) {
  const int64_t since_ns = steady_ns();
  notices_.add(message + " The pose coasts; going on when it is back");
  while (!stop_) {
    take_back();
    bool free = false;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      free = outstanding_ == 0;
    }
    if (free && camera_->come_back()) {
      char text[160];
      std::snprintf(text, sizeof(text), " is back after %.1f s", 1e-9 * static_cast<double>(steady_ns() - since_ns));
      notices_.add(camera_->name() + text);
      return true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(kWaitMs));
  }
  return false;
}

std::string LiveSource::report() {
  const std::lock_guard<std::mutex> lock(mutex_);
  const nlohmann::ordered_json json = {{"captured", captured_},
                                       {"passed_over", passed_over_},
                                       {"every_frame", every_frame_},
                                       {"interval_ms", spread(interval_ms_)},
                                       {"wait_ms", spread(wait_ms_)},
                                       {"latency_ms", spread(latency_ms_)},
                                       {"frame_ms", info_.rate_hz > 0.0 ? 1e3 / info_.rate_hz : 0.0}};
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string LiveSource::finish() {
  stop();
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(report());
  json["camera"] = nlohmann::ordered_json::parse(camera_->report());
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace pf::capture
