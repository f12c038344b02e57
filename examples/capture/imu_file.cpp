#include <planefold_platform/sequence.h>

#include <cstdio>
#include <limits>
#include <utility>

#include "imu.h"

namespace pf::capture {

namespace {

class ImuFile : public Imu {
 public:
  /// note  a line about the file, or ""
  /// first_at_frame  the first sample has the time of the first frame
  ImuFile(std::string path, pf_imu_sample_t* samples, size_t count, int64_t offset_ns, bool first_at_frame,
          std::string note)
      : path_(std::move(path)),
        samples_(samples, pf_free_imu),
        count_(count),
        offset_ns_(offset_ns),
        first_at_frame_(first_at_frame),
        note_(std::move(note)) {}

  bool start(std::string&) override { return true; }

  void begin_at(int64_t t_ns) override {
    if (!std::exchange(first_at_frame_, false) || count_ == 0) {
      return;
    }
    const int64_t shift_ns = t_ns - samples_.get()[0].t_ns;
    for (size_t i = 0; i < count_; ++i) {
      samples_.get()[i].t_ns += shift_ns;
    }
    char line[160];
    std::snprintf(line, sizeof(line),
                  "its first sample is put at the first frame, %.3f s on: its clock is not the camera's",
                  1e-9 * static_cast<double>(shift_ns));
    note_ += (note_.empty() ? path_ + ": " : "; ") + std::string(line);
  }

  void take(int64_t until_ns, std::vector<pf_imu_sample_t>& samples) override {
    for (; at_ < count_ && samples_.get()[at_].t_ns + offset_ns_ <= until_ns; ++at_) {
      samples.push_back(samples_.get()[at_]);
      samples.back().t_ns += offset_ns_;
    }
  }

  std::string name() const override { return path_; }

  bool take_notice(std::string& line) override {
    line = std::exchange(note_, "");
    return !line.empty();
  }

 private:
  std::string path_;
  std::unique_ptr<pf_imu_sample_t, void (*)(pf_imu_sample_t*)> samples_;
  size_t count_;
  int64_t offset_ns_;
  bool first_at_frame_;
  std::string note_;
  size_t at_ = 0;
};

}  // namespace

std::unique_ptr<Imu> open_imu_file(const std::string& path, int64_t offset_ns, bool first_at_frame,
                                   std::string& error) {
  char message[PF_SEQUENCE_MESSAGE] = "";
  pf_imu_sample_t* samples = nullptr;
  size_t count = 0;
  if (pf_read_imu(path.c_str(), &samples, &count, message) != 0) {
    error = message;
    return nullptr;
  }
  auto file = std::make_unique<ImuFile>(path, samples, count, offset_ns, first_at_frame, message);
  constexpr int64_t kMost = std::numeric_limits<int64_t>::max();
  if ((offset_ns > 0 && samples[count - 1].t_ns > kMost - offset_ns) ||
      (offset_ns < 0 && samples[0].t_ns < -kMost - offset_ns)) {
    error = path + ": --imu-offset takes its times out of range";
    return nullptr;
  }
  return file;
}

}  // namespace pf::capture
