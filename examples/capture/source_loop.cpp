#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "source.h"

namespace pf::capture {

namespace {

constexpr size_t kMaxBytes = size_t{1} << 30;  ///< of the images of one lap

/// The first images of another source there and back, again and again, at its rate. They are kept in memory, so that a long run costs
/// what tracking costs.
///
///   image of frame k:   j = k mod (2 lap - 2),   j where j < lap, else 2 lap - 2 - j
class Loop : public Source {
 public:
  Loop(std::unique_ptr<Source> source, int64_t frames) : source_(std::move(source)), info_(source_->info()) {
    info_.count = frames > 0 ? frames : int64_t{1} << 53;
    info_.endless = frames <= 0;
    info_.truth_path.clear();  // its times are of the first lap alone
  }

  /// Reads the images of a lap. false: error is one line.
  bool load(int64_t lap, std::string& error) {
    lap = std::min(lap, source_->info().count);
    size_t bytes = 0;
    for (int64_t k = 0; k < lap; ++k) {
      Image next;
      const Read read = source_->read(k, next.image, error);
      if (read == Read::kEnd) {
        break;
      }
      if (read != Read::kDone) {
        return false;
      }
      bytes += static_cast<size_t>(next.image.width) * static_cast<size_t>(next.image.height);
      if (bytes > kMaxBytes) {
        error = "--loop " + std::to_string(lap) + ": more than 1 GiB of images; loop over fewer, or over smaller ones";
        return false;
      }
      for (int32_t y = 0; y < next.image.height; ++y) {
        const uint8_t* row = next.image.pixels + static_cast<ptrdiff_t>(y) * next.image.stride;
        next.pixels.insert(next.pixels.end(), row, row + next.image.width);
      }
      next.image.stride = next.image.width;
      info_.knows_truth = source_->truth(next.truth);
      images_.push_back(std::move(next));
    }
    if (images_.size() < 2) {
      error = "--loop: needs two images at least";
      return false;
    }
    return true;
  }

  const SourceInfo& info() const override { return info_; }

  Read read(int64_t index, pf_image_t& image, std::string&) override {
    now_ = number(index);
    now_t_ns_ = static_cast<int64_t>(std::llround(1e9 * static_cast<double>(index) / info_.rate_hz));
    image = images_[now_].image;
    image.pixels = images_[now_].pixels.data();
    image.t_ns = now_t_ns_;
    return Read::kDone;
  }

  std::string name(int64_t index) const override { return source_->name(static_cast<int64_t>(number(index))); }

  bool truth(pf_pose_t& pose) override {
    pose = images_[now_].truth;
    pose.t_ns = now_t_ns_;
    return info_.knows_truth;
  }

  bool take_notice(std::string& line) override { return source_->take_notice(line); }
  bool target(pf_target_t& target) const override { return source_->target(target); }
  std::vector<std::array<double, 4>> planes() const override { return source_->planes(); }

 private:
  struct Image {
    pf_image_t image{};
    std::vector<uint8_t> pixels;
    pf_pose_t truth{};
  };

  size_t number(int64_t index) const {
    const auto period = static_cast<int64_t>(2 * images_.size() - 2);
    const int64_t j = index % period;
    return static_cast<size_t>(std::min(j, period - j));
  }

  std::unique_ptr<Source> source_;
  SourceInfo info_;
  std::vector<Image> images_;
  size_t now_ = 0;
  int64_t now_t_ns_ = 0;
};

}  // namespace

std::unique_ptr<Source> open_loop(const Options& options, std::unique_ptr<Source> source, std::string& error) {
  auto loop = std::make_unique<Loop>(std::move(source), options.frames > 0 ? options.skip + options.frames : 0);
  if (!loop->load(options.loop, error)) {
    return nullptr;
  }
  return loop;
}

}  // namespace pf::capture
