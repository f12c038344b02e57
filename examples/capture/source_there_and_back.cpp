#include <algorithm>
#include <utility>
#include <vector>

#include "source.h"

namespace pf::capture {

namespace {

/// Every frame of another source in order, then all but the last in reverse order, in mirrored time: the image of time t comes
/// back at 2 t_last - t.
class ThereAndBack : public Source {
 public:
  /// first  number of the frame to begin with
  /// count  of frames from there
  ThereAndBack(std::unique_ptr<Source> source, int64_t first, int64_t count)
      : source_(std::move(source)), info_(source_->info()), first_(first), count_(count) {
    info_.count = first_ + 2 * count_ - 1;
  }

  const SourceInfo& info() const override { return info_; }

  Read read(int64_t index, pf_image_t& image, std::string& error) override {
    int64_t k = index - first_;
    if (k < count_) {
      const Read read = source_->read(index, image, error);
      if (read == Read::kDone) {
        keep(image);
        return read;
      }
      if (read != Read::kEnd || frames_.empty()) {
        return read == Read::kUnusable ? Read::kFailed : read;  // each image is needed twice
      }
      count_ = static_cast<int64_t>(frames_.size());  // the source had fewer than it said
    }
    k = 2 * (count_ - 1) - k;
    if (k < 0) {
      return Read::kEnd;
    }
    now_ = &frames_[static_cast<size_t>(k)];
    const int64_t turn_ns = frames_[static_cast<size_t>(count_ - 1)].image.t_ns;
    if (now_->pixels.empty()) {
      const Read read = source_->read(first_ + k, image, error);
      if (read != Read::kDone) {
        return read;
      }
    } else {
      image = now_->image;
      image.pixels = now_->pixels.data();
    }
    image.t_ns = turn_ns + (turn_ns - now_->image.t_ns);
    now_t_ns_ = image.t_ns;
    return Read::kDone;
  }

  std::string name(int64_t index) const override {
    const int64_t k = index - first_;
    return source_->name(first_ + (k < count_ ? k : 2 * (count_ - 1) - k));
  }

  bool truth(pf_pose_t& pose) override {
    if (now_ == nullptr || !now_->has_truth) {
      return false;
    }
    pose = now_->truth;
    pose.t_ns = now_t_ns_;
    return true;
  }

  bool target(pf_target_t& target) const override { return source_->target(target); }
  std::vector<std::array<double, 4>> planes() const override { return source_->planes(); }

  bool take_notice(std::string& line) override { return source_->take_notice(line); }
  std::string finish() override { return source_->finish(); }
  bool turn(int64_t& t_ns, int64_t& images) const override {
    images = static_cast<int64_t>(frames_.size());
    t_ns = images > 0 ? frames_.back().image.t_ns : 0;
    return images > 0;
  }

 private:
  struct Frame {
    pf_image_t image{};
    std::vector<uint8_t> pixels;  ///< empty where the source can be asked again
    bool has_truth = false;
    pf_pose_t truth{};
  };

  void keep(const pf_image_t& image) {
    Frame frame;
    frame.image = image;
    if (!source_->reads_in_any_order()) {
      frame.pixels.reserve(static_cast<size_t>(image.width) * static_cast<size_t>(image.height));
      for (int32_t y = 0; y < image.height; ++y) {
        const uint8_t* row = image.pixels + static_cast<ptrdiff_t>(y) * image.stride;
        frame.pixels.insert(frame.pixels.end(), row, row + image.width);
      }
      frame.image.stride = image.width;
    }
    frame.has_truth = source_->truth(frame.truth);
    frames_.push_back(std::move(frame));
    now_ = &frames_.back();
    now_t_ns_ = image.t_ns;
  }

  std::unique_ptr<Source> source_;
  SourceInfo info_;
  int64_t first_, count_;
  std::vector<Frame> frames_;
  const Frame* now_ = nullptr;
  int64_t now_t_ns_ = 0;
};

}  // namespace

std::unique_ptr<Source> open_there_and_back(const Options& options, std::unique_ptr<Source> source,
                                            std::string& error) {
  const SourceInfo& info = source->info();
  const double readout_s = options.readout_s >= 0.0 ? options.readout_s : info.camera.readout_s;
  if (readout_s > 0.0) {
    error = "--there-and-back: the rows of a rolling shutter would be read out backwards; add --readout 0";
    return nullptr;
  }
  const int64_t left = info.count - options.skip;
  if (left <= 0) {
    return source;  // the run says that nothing is left
  }
  const int64_t count = options.frames > 0 ? std::min(left, options.frames) : left;
  return std::make_unique<ThereAndBack>(std::move(source), options.skip, count);
}

}  // namespace pf::capture
