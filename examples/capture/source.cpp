#include "source.h"

#include <planefold_platform/cameras.h>
#include <planefold_platform/sequence.h>
#include <planefold_platform/sim.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <vector>

#include "camera.h"
#include "focal_search.h"
#include "imu.h"
#include "live_source.h"

namespace pf::capture {

std::unique_ptr<Imu> Source::imu(int64_t) const { return nullptr; }

namespace {

class FolderSource : public Source {
 public:
  /// name   as in --source
  /// guess  of the camera, where there is no calibration
  FolderSource(pf_sequence_t* sequence, const std::string& name, const std::optional<pf_camera_t>& guess)
      : sequence_(sequence, pf_close_sequence) {
    pf_sequence_info_t info{};
    pf_get_sequence_info(sequence, &info);
    info_.camera = guess.value_or(info.camera);
    info_.count = info.count;
    info_.rate_hz = info.rate_hz;
    info_.truth_path = info.truth_path;
    info_.warning = info.warning;
    info_.camera_name = info.camera_name;
    info_.imu_path = info.imu_path;
    info_.mask_path = info.mask_path;
    info_.target_path = target_beside(name.substr(name.find(':') + 1));
    in_order_ = info.in_order != 0;
  }

  const SourceInfo& info() const override { return info_; }

  /// Of a recording, only the frames that were tracked when it was made. false: error is one line.
  bool keep_tracked(const std::string& source, std::string& error) {
    const std::string folder = source.substr(source.find(':') + 1);
    std::vector<int64_t> times;
    std::vector<int64_t> kept;
    for (const char* below : {"/mav0/cam0/tracked.csv", "/cam0/tracked.csv", "/tracked.csv"}) {
      std::ifstream file(folder + below);
      for (std::string line; std::getline(file, line);) {
        if (!line.empty() && line[0] != '#') {
          times.push_back(std::strtoll(line.c_str(), nullptr, 10));
        }
      }
    }
    if (times.empty()) {
      error = folder + ": no tracked.csv inside that names a frame; leave --as-recorded away to track every frame";
      return false;
    }
    std::sort(times.begin(), times.end());
    for (int64_t i = 0; i < info_.count; ++i) {
      const std::string stem = std::filesystem::path(name(i)).stem().string();  // the time, in recordings
      if (std::binary_search(times.begin(), times.end(), std::strtoll(stem.c_str(), nullptr, 10))) {
        kept.push_back(i);
      }
    }
    if (kept.size() != times.size()) {
      error = folder + ": tracked.csv names " + std::to_string(times.size()) + " frames, and " +
              std::to_string(kept.size()) + " of them are there";
      return false;
    }
    kept_.swap(kept);
    info_.count = static_cast<int64_t>(kept_.size());
    return true;
  }

  Read read(int64_t index, pf_image_t& image, std::string& error) override {
    char message[PF_SEQUENCE_MESSAGE];
    const int result = pf_read_sequence_frame(sequence_.get(), number(index), &image, message);
    if (result == PF_SEQUENCE_END) {
      notice_ = message;
      return Read::kEnd;
    }
    error = message;
    return result == 0 ? Read::kDone : result == PF_SEQUENCE_UNUSABLE_IMAGE ? Read::kUnusable : Read::kFailed;
  }

  bool reads_in_any_order() const override { return !in_order_; }

  bool take_notice(std::string& line) override {
    line.swap(notice_);
    notice_.clear();
    return !line.empty();
  }

  std::string name(int64_t index) const override { return pf_get_sequence_frame_path(sequence_.get(), number(index)); }

 private:
  /// path  a folder, a film, or a folder with a pattern of names
  static std::string target_beside(const std::filesystem::path& path) {
    std::error_code ignored;
    const bool is_folder = std::filesystem::is_directory(path, ignored);
    const std::filesystem::path file = (is_folder ? path : path.parent_path()) / "target.yaml";
    return std::filesystem::is_regular_file(file, ignored) ? file.string() : "";
  }
  int64_t number(int64_t index) const { return kept_.empty() ? index : kept_[static_cast<size_t>(index)]; }

  std::vector<int64_t> kept_;
  bool in_order_ = false;
  std::string notice_;  ///< not told yet
  std::unique_ptr<pf_sequence_t, void (*)(pf_sequence_t*)> sequence_;
  SourceInfo info_;
};

}  // namespace

namespace {

std::unique_ptr<Source> open_stored(const Options& options, std::string& error) {
  if (options.source.rfind("sim:", 0) == 0) {
    return open_sim_source(options, error);
  }
  char message[PF_SEQUENCE_MESSAGE];
  pf_sequence_t* sequence = nullptr;
  const char* calibration = is_uncalibrated(options)      ? PF_SEQUENCE_UNCALIBRATED
                            : options.calibration.empty() ? nullptr
                                                          : options.calibration.c_str();
  if (pf_open_sequence_of(options.source.c_str(), calibration, options.camera.c_str(), &sequence, message) != 0) {
    error = message;
    return nullptr;
  }
  auto folder = std::make_unique<FolderSource>(sequence, options.source, options.guess);
  if (options.as_recorded && !folder->keep_tracked(options.source, error)) {
    return nullptr;
  }
  return folder;
}

}  // namespace

std::unique_ptr<Source> open_camera_source(const Options& options, std::string& error) {
  SourceInfo info;
  if (options.calibration.empty()) {
    error = "source '" + options.source +
            "': a camera needs its calibration; give it with --calib FILE (pf-calibrate makes one)";
    return nullptr;
  }
  char message[PF_SEQUENCE_MESSAGE];
  if (pf_read_calibration_of(options.calibration.c_str(), options.camera.c_str(), &info.camera, &info.rate_hz,
                             message) != 0) {
    error = message;
    return nullptr;
  }
  info.warning = message;
  info.camera_name = options.camera;
  std::unique_ptr<Camera> camera = open_device_camera(options, info.camera, info.rate_hz, error);
  if (camera == nullptr) {
    return nullptr;
  }
  info.endless = true;
  info.count = int64_t{1} << 53;
  info.device = camera->name();
  return std::make_unique<LiveSource>(std::move(camera), options, info);
}

std::unique_ptr<Source> open_source(const Options& options, std::string& error) {
  if (platform::is_camera(options.source)) {
    return open_camera_source(options, error);
  }
  std::unique_ptr<Source> stored = open_stored(options, error);
  if (stored != nullptr && options.every > 1) {
    stored = open_every(options, std::move(stored));
  }
  if (stored != nullptr && !options.cover_s.empty()) {
    stored = open_cover(options, std::move(stored));
  }
  if (stored != nullptr && options.loop > 0) {
    return open_loop(options, std::move(stored), error);
  }
  if (stored != nullptr && options.there_and_back) {
    return open_there_and_back(options, std::move(stored), error);
  }
  if (stored == nullptr || !options.realtime) {
    return stored;
  }
  SourceInfo info = stored->info();
  info.device = options.source;
  return std::make_unique<LiveSource>(open_paced_camera(options, std::move(stored)), options, info);
}

bool is_command_line_wrong(const Options& options) {
  const std::string kind = options.source.substr(0, options.source.find(':'));
  pf_sim_options_t scene;
  if (kind == "sim" && pf_sim_options_default(options.source.c_str() + 4, &scene) != PF_OK) return true;
  const char* calibration = options.calibration.empty() ? nullptr : options.calibration.c_str();
  char message[PF_SEQUENCE_MESSAGE];
  if (kind == "images" || kind == "euroc" || kind == "tum") {
    pf_sequence_t* sequence = nullptr;
    const int done =
        pf_open_sequence_of(options.source.c_str(), calibration, options.camera.c_str(), &sequence, message);
    pf_close_sequence(sequence);
    return done == PF_SEQUENCE_WRONG_CALIBRATION;
  }
  pf_camera_t camera;
  return calibration != nullptr &&
         pf_read_calibration_of(calibration, options.camera.c_str(), &camera, nullptr, message) != 0;
}

}  // namespace pf::capture
