// Contexts that are saved to go on with: numbers of a real one are replaced, under CRCs that fit, and what is loaded has to run, or is
// refused and leaves a new context. An input is a choice of the context, and then five bytes for each number: where, and what in its place.
#include <planefold/planefold.h>

#include <cstring>
#include <vector>

#include "bytes.h"
#include "guarded.h"
#include "memory/crc32c.h"

namespace {

constexpr int kWidth = 160, kHeight = 120, kFrames = 40, kContexts = 4;
constexpr std::size_t kOrigin = 32, kLive = kOrigin + 24 + 24, kHeader = 24;

/// Squares of two depths before a camera that moves sideways.
void draw(int frame, std::vector<uint8_t>* grey) {
  const auto hash = [](int x, int y) {
    return (static_cast<uint32_t>(x) * 73856093u ^ static_cast<uint32_t>(y) * 19349663u) * 2654435761u >> 24;
  };
  grey->resize(kWidth * kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const int far = x + frame, near = x + 3 * frame;
      const bool is_near = hash(near / 23, 7 + y / 19) % 3 == 0;
      (*grey)[static_cast<size_t>(y * kWidth + x)] =
          static_cast<uint8_t>(is_near ? hash(near / 6, 100 + y / 5) : hash(far / 7, y / 6));
    }
}

pf_status_t push(pf_slam_t* slam, int frame) {
  static std::vector<uint8_t> grey;
  draw(frame, &grey);
  const pf_image_t image = {grey.data(), kWidth, kHeight, kWidth, (frame + 1) * int64_t{33333333}};
  return pf_push_frame(slam, &image);
}

struct Context {
  pf_slam_t* slam;
  std::vector<uint8_t> saved;
};

Context created(int which) {
  pf_config_t config;
  require(pf_config_default(&config) == PF_OK, "a default config");
  config.camera = {PF_CAMERA_PINHOLE,  kWidth, kHeight, 120, 120, 79.5, 59.5, {}, 0, PF_CAMERA_EXACT,
                   PF_TIMESTAMPS_REAL, 0,      0,       0,   {}};
  config.backend = which % 2 == 0 ? PF_BACKEND_FILTER : PF_BACKEND_WINDOW;
  config.capacity.max_places = 4;
  config.capacity.max_imu_samples = 100;
  if (which == 2) {
    config.motion.model = PF_MOTION_INERTIAL;
    config.imu.gyro_density = 0.001, config.imu.accel_density = 0.01,
    config.imu.gyro_walk = config.imu.accel_walk = 1e-4;
    config.imu.sigma_delay_s = 0.01;
  }
  if (which == 3) config.map.masks = PF_MASKS_PARTIAL;
  pf_memory_t need;
  require(pf_memory_query(&config, &need) == PF_OK, "a possible config");
  auto* const block = new Guarded(need.bytes, need.alignment, which / 2 % 2 == 0);  // for all inputs
  std::memset(block->begin(), 0x7f, need.bytes);
  Context out = {};
  require(pf_create(&config, block->begin(), need.bytes, &out.slam) == PF_OK, "a context");
  for (int k = 0; k < kFrames; ++k) {
    for (int s = 0; which == 2 && s < 4; ++s) {
      const pf_imu_sample_t sample = {k * int64_t{33333333} + s * int64_t{8333333} + 1, {0.01, 0, 0}, {0.5, -9.8, 0.1}};
      pf_push_imu(out.slam, &sample, 1);
    }
    require(push(out.slam, k) >= PF_OK, "a frame is taken");
  }
  size_t bytes = 0;
  require(pf_map_size(out.slam, PF_MAP_CONTINUE, &bytes) == PF_OK, "a context can be saved");
  out.saved.resize(bytes);
  require(pf_save_map(out.slam, PF_MAP_CONTINUE, out.saved.data(), bytes, &bytes) == PF_OK, "a context is saved");
  return out;
}

/// Replaces numbers of LIVE, and makes its CRC fit.
std::vector<uint8_t> forged(const std::vector<uint8_t>& saved, const uint8_t* data, size_t size) {
  std::vector<uint8_t> map = saved;
  const size_t length = map.size() - kLive - kHeader;
  for (; size >= 5; data += 5, size -= 5) {
    const size_t at = (data[0] | static_cast<size_t>(data[1]) << 8 | static_cast<size_t>(data[2]) << 16) % length;
    map[kLive + kHeader + at] = data[3];
    if (at + 1 < length) map[kLive + kHeader + at + 1] ^= data[4];
  }
  const uint32_t crc = pf::crc32c(map.data() + kLive + kHeader, length, pf::crc32c(map.data() + kLive, 16));
  std::memcpy(map.data() + kLive + 16, &crc, sizeof crc);
  return map;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  static Context contexts[kContexts] = {created(0), created(1), created(2), created(3)};
  Context& context = contexts[data[0] % kContexts];
  pf_slam_t* const slam = context.slam;
  const std::vector<uint8_t> map = forged(context.saved, data + 1, size - 1);
  require(pf_reset(slam) == PF_OK, "a reset");
  const pf_status_t status = pf_load_map(slam, map.data(), map.size());
  require(status == PF_OK || status == PF_ERROR_MAP, "a context is taken or refused as what it is");
  pf_report_t report;
  require(pf_get_report(slam, &report) == PF_OK, "a report");
  if (status != PF_OK) {
    require(report.frames == 0 && report.state == PF_STATE_STARTING, "a refusal leaves a new context");
    require(pf_load_map(slam, context.saved.data(), context.saved.size()) == PF_OK, "which takes a sound one");
    return 0;
  }
  for (int k = kFrames; k < kFrames + 3; ++k) push(slam, k);
  pf_pose_t pose;
  std::vector<pf_feature_t> features(1000);
  std::vector<pf_plane_t> planes(64);
  size_t count = 0;
  pf_get_pose(slam, &pose);
  pf_get_features(slam, features.data(), features.size(), &count);
  pf_get_planes(slam, planes.data(), planes.size(), &count);
  std::vector<uint8_t> again(size_t{1} << 22);
  pf_save_map(slam, PF_MAP_PORTABLE, again.data(), again.size(), &count);
  pf_save_map(slam, PF_MAP_CONTINUE, again.data(), again.size(), &count);
  return 0;
}
