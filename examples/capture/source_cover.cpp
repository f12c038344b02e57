#include <cmath>
#include <utility>
#include <vector>

#include "imu.h"
#include "source.h"

namespace pf::capture {

namespace {

/// The frames of another source, black while the lens is covered: from one time to another after the first frame.
class Cover : public Source {
 public:
  Cover(std::unique_ptr<Source> source, double from_s, double to_s)
      : source_(std::move(source)), from_ns_(std::llround(1e9 * from_s)), to_ns_(std::llround(1e9 * to_s)) {}

  const SourceInfo& info() const override { return source_->info(); }

  Read read(int64_t index, pf_image_t& image, std::string& error) override {
    const Read read = source_->read(index, image, error);
    if (read != Read::kDone) {
      return read;
    }
    if (!has_first_) first_ns_ = image.t_ns;
    has_first_ = true;
    const int64_t since_ns = image.t_ns - first_ns_;
    if (since_ns >= from_ns_ && since_ns < to_ns_) {
      black_.assign(static_cast<size_t>(image.width) * static_cast<size_t>(image.height), 0);
      image.pixels = black_.data();
      image.stride = image.width;
    }
    return read;
  }

  std::string name(int64_t index) const override { return source_->name(index); }
  bool truth(pf_pose_t& pose) override { return source_->truth(pose); }
  bool target(pf_target_t& target) const override { return source_->target(target); }
  std::vector<std::array<double, 4>> planes() const override { return source_->planes(); }
  std::unique_ptr<Imu> imu(int64_t offset_ns) const override { return source_->imu(offset_ns); }
  bool take_notice(std::string& line) override { return source_->take_notice(line); }
  std::string report() override { return source_->report(); }
  std::string finish() override { return source_->finish(); }

 private:
  std::unique_ptr<Source> source_;
  int64_t from_ns_, to_ns_, first_ns_ = 0;
  bool has_first_ = false;
  std::vector<uint8_t> black_;
};

}  // namespace

std::unique_ptr<Source> open_cover(const Options& options, std::unique_ptr<Source> source) {
  return std::make_unique<Cover>(std::move(source), options.cover_s[0], options.cover_s[1]);
}

}  // namespace pf::capture
