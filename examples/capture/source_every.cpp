#include <utility>

#include "imu.h"
#include "source.h"

namespace pf::capture {

namespace {

/// One frame in so many of a folder, as a slower camera would have taken them.
class Every : public Source {
 public:
  Every(std::unique_ptr<Source> source, int64_t step)
      : source_(std::move(source)), info_(source_->info()), step_(step) {
    info_.count = (info_.count + step - 1) / step;
    info_.rate_hz /= static_cast<double>(step);
  }

  const SourceInfo& info() const override { return info_; }
  Read read(int64_t index, pf_image_t& image, std::string& error) override {
    return source_->read(index * step_, image, error);
  }
  std::string name(int64_t index) const override { return source_->name(index * step_); }
  bool truth(pf_pose_t& pose) override { return source_->truth(pose); }
  bool target(pf_target_t& target) const override { return source_->target(target); }
  bool depth(std::vector<float>& z, std::vector<int32_t>& surface) const override { return source_->depth(z, surface); }
  std::vector<std::array<double, 4>> planes() const override { return source_->planes(); }
  std::unique_ptr<Imu> imu(int64_t offset_ns) const override { return source_->imu(offset_ns); }
  bool reads_in_any_order() const override { return source_->reads_in_any_order(); }
  bool take_notice(std::string& line) override { return source_->take_notice(line); }
  std::string report() override { return source_->report(); }
  std::string finish() override { return source_->finish(); }

 private:
  std::unique_ptr<Source> source_;
  SourceInfo info_;
  int64_t step_;
};

}  // namespace

std::unique_ptr<Source> open_every(const Options& options, std::unique_ptr<Source> source) {
  return std::make_unique<Every>(std::move(source), options.every);
}

}  // namespace pf::capture
