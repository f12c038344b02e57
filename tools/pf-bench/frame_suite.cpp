// Whole frames: pf_push_frame on real sequences beside OpenCV's optical flow on the same frames, interleaved frame by frame.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "flow_peer.h"
#include "frame_source.h"
#include "suite.h"
#include "thread_time.h"

namespace bench {
namespace {

constexpr const char* kStages[] = {"pyramid", "predict", "search", "gate", "update", "map"};
constexpr int kStageCount = PF_STAGE_MAP + 1;

/// For both sides, which have one thread.
int64_t clock_ns(void*) { return thread_ns(); }

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<size_t>(at)];
}

/// The same list of names as on the command line.
uint32_t kernels_by_name(const std::string& name) {
  constexpr const char* kNames[] = {"auto", "reference", "portable", "avx2", "avx512", "neon"};
  for (uint32_t i = 0; i < 6; ++i) {
    if (name == kNames[i]) return i;
  }
  return name.empty() ? PF_KERNELS_AUTO : 99;  // 99: the config is refused, with the field's name
}

/// First velocities of a hand [m/s, rad/s].
constexpr double kHandVariance = 0.25;
constexpr double kHandCovariance[36] = {kHandVariance, 0, 0, 0, 0, 0, 0, kHandVariance, 0, 0, 0, 0, 0, 0,
                                        kHandVariance, 0, 0, 0, 0, 0, 0, kHandVariance, 0, 0, 0, 0, 0, 0,
                                        kHandVariance, 0, 0, 0, 0, 0, 0, kHandVariance};

/// Patches that the last frame measured.
int count_patches(const pf_slam_t* slam) {
  pf_patch_t patches[32];
  size_t count = 0;
  if (pf_get_patches(slam, patches, 32, &count) < 0) return 0;
  return static_cast<int>(std::count_if(patches, patches + std::min<size_t>(count, 32),
                                        [](const pf_patch_t& p) { return p.status == PF_MATCH_INLIER; }));
}

/// Samples of one sequence, frames with a tracked camera only; all in microseconds.
struct Samples {
  std::vector<double> own, peer, stage[kStageCount], patch, patches, inliers, attempts, features, state_dim;
  int64_t frames = 0, tracked = 0;
};

class FrameSuite {
 public:
  explicit FrameSuite(const SuiteOptions& options) : options_(options), report_(options) {}

  int run() {
    report_.note("scalar", scalar_name());
    report_.note("peer", peer_.name());
    report_.note("clock", "processor time of the one thread");
    const std::vector<std::string> sources =
        options_.sources.empty() ? default_sources(std::getenv("PLANEFOLD_DATA")) : options_.sources;
    for (const std::string& source : sources) {
      Frames frames;
      std::string message;
      if (!load_frames(source, options_.start, options_.calibration, options_.frames, frames, message) ||
          !(options_.walls.empty() || load_walls(options_.walls, frames, message)) || !measure(frames, message)) {
        std::fprintf(stderr, "pf-bench: %s\n", message.c_str());
        return 1;
      }
    }
    return report_.finish();
  }

 private:
  bool measure(const Frames& frames, std::string& message) {
    pf_config_t config;
    pf_config_default(&config);
    config.camera = frames.camera;
    config.kernels = kernels_by_name(options_.kernels);
    config.clock_ns = clock_ns;
    if (options_.window) config.backend = PF_BACKEND_WINDOW;
    config.map.masks = options_.masks;
    config.plane.enabled = options_.planes ? 1 : 0;
    if (options_.features > 0) config.map.features_in_view = options_.features;
    if (!frames.walls.empty()) {
      config.capacity.max_patches = options_.patches;
      config.capacity.max_planes += static_cast<int32_t>(frames.walls.size());
    }
    const char* field = "";
    pf_memory_t memory{};
    if (pf_config_check(&config, &field) != PF_OK || pf_memory_query(&config, &memory) != PF_OK) {
      message = frames.name + ": out of its range or not available here: " + field;
      return false;
    }
    const std::unique_ptr<void, void (*)(void*)> block(
        std::aligned_alloc(memory.alignment,
                           (memory.bytes + memory.alignment - 1) / memory.alignment * memory.alignment),
        std::free);
    pf_slam_t* slam = nullptr;
    pf_status_t status = block ? pf_create(&config, block.get(), memory.bytes, &slam) : PF_ERROR_MEMORY;
    Samples samples;
    for (int pass = 0; pass < options_.passes && status >= 0; ++pass) {
      if (pass > 0) status = pf_reset(slam);
      if (status >= 0 && frames.has_target) status = pf_start_from_target(slam, &frames.target);
      if (status >= 0 && frames.has_pose) status = pf_start_from_pose(slam, &frames.pose, kHandCovariance);
      for (const pf_wall_prior_t& wall : frames.walls) {
        uint32_t id = 0;
        if (status >= 0) status = pf_add_wall(slam, &wall, &id);
      }
      for (size_t i = 0; i < frames.pixels.size() && status >= 0; ++i) status = step(slam, frames, i, samples);
    }
    if (status < 0) {
      message = frames.name + ": " + pf_status_text(status);
      return false;
    }
    tell(frames, memory, samples);
    return true;
  }

  /// One frame for each of the two; who goes first changes from frame to frame, because the first one finds the picture cold.
  pf_status_t step(pf_slam_t* slam, const Frames& frames, size_t i, Samples& samples) {
    double peer = -1;
    const auto run_peer = [&] {
      if (peer_.is_there() && i > 0) {
        peer = peer_.time_us(frames.pixels[i - 1].data(), frames.pixels[i].data(), frames.camera.width,
                             frames.camera.height);
      }
    };
    const pf_image_t image = frames.image(i);
    if (i % 2 == 0) run_peer();
    const int64_t begin = clock_ns(nullptr);
    const pf_status_t status = pf_push_frame(slam, &image);
    const double own = 1e-3 * static_cast<double>(clock_ns(nullptr) - begin);
    if (i % 2 != 0) run_peer();
    if (status < 0) return status;

    pf_report_t report{};
    pf_get_report(slam, &report);
    ++samples.frames;
    if (report.state == PF_STATE_TRACKING && report.inliers >= 8) {
      ++samples.tracked;
      samples.own.push_back(own);
      if (peer >= 0) samples.peer.push_back(peer);
      for (int s = 0; s < kStageCount; ++s) samples.stage[s].push_back(1e-3 * static_cast<double>(report.stage_ns[s]));
      samples.patch.push_back(1e-3 * static_cast<double>(report.stage_ns[PF_STAGE_PATCH]));
      samples.patches.push_back(count_patches(slam));
      samples.inliers.push_back(report.inliers);
      samples.attempts.push_back(report.attempts);
      samples.features.push_back(report.features);
      samples.state_dim.push_back(report.state_dim);
    }
    return status;
  }

  void tell(const Frames& frames, const pf_memory_t& memory, const Samples& samples) {
    char line[240];
    std::snprintf(
        line, sizeof(line),
        "%dx%d, start %s, tracked %lld of %lld frames in %d passes; a frame looks for %.0f features (median), measures "
        "%.0f, of %.0f in the map; %.2f MiB",
        frames.camera.width, frames.camera.height, frames.start.c_str(), static_cast<long long>(samples.tracked),
        static_cast<long long>(samples.frames), options_.passes, quantile(samples.attempts, 0.5),
        quantile(samples.inliers, 0.5), quantile(samples.features, 0.5), static_cast<double>(memory.bytes) / 1048576.0);
    report_.note(frames.name, line);
    if (samples.own.empty()) return;  // the line above says that nothing was tracked

    const int n = static_cast<int>(quantile(samples.state_dim, 0.5));
    const int m = 2 * static_cast<int>(quantile(samples.inliers, 0.5));
    const std::string peer = samples.peer.empty() ? "" : "LK, 100 points";
    const double median = quantile(samples.own, 0.5);
    const auto row = [&](const std::string& what, double us, const std::string& beside, double beside_us) {
      report_.add({"frame", frames.name + what, scalar_name(), n, m, us, beside, beside_us > 0 ? us / beside_us : 0});
    };
    for (const auto& [what, share] : {std::pair{" median", 0.5}, {" p95", 0.95}, {" max", 1.0}}) {
      row(what, quantile(samples.own, share), peer, quantile(samples.peer, share));
    }
    if (!peer.empty()) row(" LK median", quantile(samples.peer, 0.5), "", 0);
    double sum = 0;
    for (int s = 0; s < kStageCount; ++s) {
      const double us = quantile(samples.stage[s], 0.5);
      sum += us;
      row(std::string(" ") + kStages[s], us, "frame", median);
    }
    row(" all stages", sum, "frame", median);
    if (options_.patches > 0 && !frames.walls.empty()) {
      for (const auto& [what, share] : {std::pair{" patch", 0.5}, {" patch p95", 0.95}})
        row(what, quantile(samples.patch, share), peer, quantile(samples.peer, 0.5));
      std::snprintf(line, sizeof(line), "%.0f patches measured in a frame (median)", quantile(samples.patches, 0.5));
      report_.note(frames.name + " patches", line);
    }
    report_.note(frames.name + " slowest", slowest(samples));
  }

  /// Where the slowest twentieth of the frames spends its time.
  static std::string slowest(const Samples& samples) {
    const double limit = quantile(samples.own, 0.95);
    double total = 0;
    double stage[kStageCount] = {};
    int count = 0;
    for (size_t i = 0; i < samples.own.size(); ++i) {
      if (samples.own[i] < limit) continue;
      ++count;
      total += samples.own[i];
      for (int s = 0; s < kStageCount; ++s) stage[s] += samples.stage[s][i];
    }
    char line[80];
    std::snprintf(line, sizeof(line), "5 %% of frames take %.2f ms on average:", 1e-3 * total / count);
    std::string text = line;
    for (int s = 0; s < kStageCount; ++s) {
      std::snprintf(line, sizeof(line), " %s %.2f", kStages[s], 1e-3 * stage[s] / count);
      text += line;
    }
    return text;
  }

  SuiteOptions options_;
  Report report_;
  FlowPeer peer_;
};

int run_frame(const SuiteOptions& options) { return FrameSuite(options).run(); }

const Suite frame_suite("frame", "whole frames of real sequences, beside OpenCV's optical flow on 100 points",
                        run_frame, Suite::kSequences);

}  // namespace
}  // namespace bench
