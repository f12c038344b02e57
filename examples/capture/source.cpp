#include "source.h"

#include <planefold_platform/sequence.h>

namespace pf::capture {

namespace {

class FolderSource : public Source {
 public:
  explicit FolderSource(pf_sequence_t* sequence) : sequence_(sequence, pf_close_sequence) {
    pf_sequence_info_t info{};
    pf_get_sequence_info(sequence, &info);
    info_.camera = info.camera;
    info_.count = info.count;
    info_.rate_hz = info.rate_hz;
    info_.truth_path = info.truth_path;
    info_.warning = info.warning;
  }

  const SourceInfo& info() const override { return info_; }

  Read read(int64_t index, pf_image_t& image, std::string& error) override {
    char message[PF_SEQUENCE_MESSAGE];
    const bool done = pf_read_sequence_frame(sequence_.get(), index, &image, message) == 0;
    error = message;
    return done ? Read::kDone : Read::kFailed;
  }

  std::string name(int64_t index) const override { return pf_get_sequence_frame_path(sequence_.get(), index); }

 private:
  std::unique_ptr<pf_sequence_t, void (*)(pf_sequence_t*)> sequence_;
  SourceInfo info_;
};

}  // namespace

std::unique_ptr<Source> open_source(const Options& options, std::string& error) {
  if (options.source.rfind("sim:", 0) == 0) {
    return open_sim_source(options, error);
  }
  char message[PF_SEQUENCE_MESSAGE];
  pf_sequence_t* sequence = nullptr;
  const char* calibration = options.calibration.empty() ? nullptr : options.calibration.c_str();
  if (pf_open_sequence(options.source.c_str(), calibration, &sequence, message) != 0) {
    error = message;
    return nullptr;
  }
  return std::make_unique<FolderSource>(sequence);
}

}  // namespace pf::capture
