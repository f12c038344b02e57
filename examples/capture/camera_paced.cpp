#include <algorithm>
#include <array>
#include <thread>
#include <vector>

#include "camera.h"
#include "steady.h"

namespace pf::capture {

namespace {

/// Frames come when their timestamps say so, counted from the first one. What is read late comes at once.
class PacedCamera : public Camera {
 public:
  PacedCamera(const Options& options, std::unique_ptr<Source> source)
      : source_(std::move(source)), at_(options.skip), end_(source_->info().count) {}

  bool start(std::string& error) override {
    const CameraRead read = load(error);
    if (read == CameraRead::kFailed) {
      return false;
    }
    begin_ns_ = steady_ns();
    first_t_ns_ = waiting_ ? next_.image.t_ns : 0;
    return true;
  }

  CameraRead next(int timeout_ms, CameraFrame& frame, std::string& message) override {
    if (!waiting_) {
      const CameraRead read = load(message);
      if (read != CameraRead::kFrame) {
        return read;
      }
    }
    const int64_t due_ns = begin_ns_ + next_.image.t_ns - first_t_ns_;
    const int64_t now_ns = steady_ns();
    if (due_ns > now_ns) {
      std::this_thread::sleep_for(
          std::chrono::nanoseconds(std::min<int64_t>(due_ns - now_ns, int64_t{timeout_ms} * 1000000)));
    }
    if (steady_ns() < due_ns) {
      return CameraRead::kNothing;
    }
    const auto free = std::find(held_.begin(), held_.end(), false);
    if (free == held_.end()) {
      ++lost_;  // as a camera does whose buffers are all with the caller
      waiting_ = false;
      return CameraRead::kNothing;
    }
    const auto slot = static_cast<size_t>(free - held_.begin());
    *free = true;
    pixels_[slot].swap(loaded_);
    frame = next_;
    frame.image.pixels = pixels_[slot].data();
    frame.handle = static_cast<int32_t>(slot);
    frame.arrived_ns = steady_ns();
    waiting_ = false;
    return CameraRead::kFrame;
  }

  void release(const CameraFrame& frame) override { held_[static_cast<size_t>(frame.handle)] = false; }
  std::string name() const override { return source_->name(at_ - 1); }
  std::string report() const override {
    return "{\"lost\": " + std::to_string(lost_) + ", \"damaged\": " + std::to_string(damaged_) + "}";
  }
  bool target(pf_target_t& target) const override { return source_->target(target); }

 private:
  static constexpr size_t kSlots = 6;

  /// Reads ahead, so that reading and rendering do not delay the frame.
  CameraRead load(std::string& message) {
    pf_image_t image{};
    Read read = Read::kUnusable;
    while (read == Read::kUnusable) {
      if (at_ >= end_) {
        message.clear();
        return CameraRead::kEnd;
      }
      read = source_->read(at_, image, message);
      at_ += read == Read::kUnusable ? 1 : 0;
      damaged_ += read == Read::kUnusable ? 1 : 0;
    }
    if (read != Read::kDone) {
      message = "frame " + std::to_string(at_) + ": " + message;
      return read == Read::kEnd ? CameraRead::kEnd : CameraRead::kFailed;
    }
    next_ = CameraFrame{};
    next_.number = at_++;
    next_.image = image;
    next_.image.stride = image.width;
    next_.has_truth = source_->truth(next_.truth);
    loaded_.resize(static_cast<size_t>(image.width) * static_cast<size_t>(image.height));
    for (int32_t y = 0; y < image.height; ++y) {
      std::copy_n(image.pixels + static_cast<ptrdiff_t>(y) * image.stride, image.width,
                  loaded_.begin() + static_cast<ptrdiff_t>(y) * image.width);
    }
    waiting_ = true;
    return CameraRead::kFrame;
  }

  std::unique_ptr<Source> source_;
  int64_t at_, end_;
  int64_t begin_ns_ = 0, first_t_ns_ = 0, lost_ = 0, damaged_ = 0;
  bool waiting_ = false;
  CameraFrame next_;
  std::vector<uint8_t> loaded_;
  std::array<std::vector<uint8_t>, kSlots> pixels_;
  std::array<bool, kSlots> held_{};
};

}  // namespace

std::unique_ptr<Camera> open_paced_camera(const Options& options, std::unique_ptr<Source> source) {
  return std::make_unique<PacedCamera>(options, std::move(source));
}

}  // namespace pf::capture
