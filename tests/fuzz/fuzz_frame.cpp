// The frame door: any order of calls with any numbers in them. Nothing crashes, and a refusal changes nothing.
#include <planefold/planefold.h>

#include <cmath>
#include <cstdlib>
#include <vector>

#include "bytes.h"

namespace {

constexpr int kWidth = 80, kHeight = 64;

/// What can be seen of a context from outside.
struct View {
  pf_report_t report;
  pf_pose_t pose;
  pf_state_t state;
  pf_status_t status[3];

  explicit View(const pf_slam_t* slam) {
    std::memset(static_cast<void*>(this), 0, sizeof(*this));
    status[0] = pf_get_report(slam, &report);
    status[1] = pf_get_pose(slam, &pose);
    status[2] = pf_get_state(slam, &state);
  }
  bool operator==(const View& other) const {
    return std::memcmp(static_cast<const void*>(this), static_cast<const void*>(&other), sizeof(*this)) == 0;
  }
};

pf_status_t step(pf_slam_t* slam, Bytes& bytes, int64_t& t_ns, std::vector<uint8_t>& pixels) {
  const uint8_t what = bytes.take<uint8_t>();
  switch (what % 8) {
    case 0:
    case 1:
    case 2: {  // a frame that moves, of blocks whose grey levels come from the bytes
      uint8_t grey[16], shift = bytes.take<uint8_t>();
      bytes.take(grey, sizeof(grey));
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
          pixels[static_cast<size_t>(y * kWidth + x)] = grey[((x + shift) / 6 * 7 + y / 5 * 3) % 16];
      t_ns += 33000000;
      const pf_image_t image = {pixels.data(), kWidth, kHeight, kWidth, t_ns};
      return pf_push_frame(slam, &image);
    }
    case 3: {  // a frame with wrong numbers; pixels are there for the right ones only
      pf_image_t image = {pixels.data(), kWidth, kHeight, kWidth, bytes.take<int64_t>()};
      if (what & 8) image.pixels = nullptr;
      if (what & 16) image.stride = bytes.take<int32_t>() % kWidth;
      if (what & 32) image.width = -image.width;
      if (what & 64) image.height = bytes.take<int32_t>() % kHeight;
      const pf_status_t status = pf_push_frame(slam, &image);
      if (status >= PF_OK) t_ns = image.t_ns;
      return status;
    }
    case 4: {
      pf_observation_t observations[12];
      const size_t count = bytes.take<uint8_t>() % 13;
      for (size_t i = 0; i < count; ++i) {
        if (what & 8) {
          bytes.take(&observations[i], sizeof(observations[i]));
        } else {
          observations[i] = {static_cast<uint32_t>(i),
                             {double(bytes.take<uint8_t>() % kWidth), double(bytes.take<uint8_t>() % kHeight)},
                             0.0};
        }
      }
      t_ns += 33000000;
      return pf_push_observations(slam, t_ns, observations, count);
    }
    case 5: {
      pf_pose_t pose;
      double velocity_covariance[36];
      bytes.take(&pose, sizeof(pose));
      bytes.take(velocity_covariance, sizeof(velocity_covariance));
      return pf_start_from_pose(slam, &pose, velocity_covariance);
    }
    case 6: {
      pf_target_t target;
      bytes.take(&target, sizeof(target));
      if (what & 8) target.kind = PF_TARGET_RECTANGLE;
      return pf_start_from_target(slam, &target);
    }
    default: {
      if (what & 128) {
        t_ns = 0;
        return pf_reset(slam);
      }
      double point[3], pixel[2], covariance[4];
      pf_pose_t pose;
      pf_feature_t features[4];
      pf_match_t tracks[4];
      size_t count = 0;
      bytes.take(point, sizeof(point));
      pf_project_point(slam, point, pixel, covariance);
      pf_predict_pose(slam, bytes.take<int64_t>(), &pose);
      pf_get_features(slam, features, 4, &count);
      pf_get_matches(slam, tracks, 4, &count);
      return what & 64 ? pf_withdraw_target(slam) : PF_OK;
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Bytes bytes(data, size);
  pf_config_t config;
  pf_config_default(&config);
  config.camera = {PF_CAMERA_PINHOLE,  kWidth, kHeight, 60.0, 60.0, 39.5, 31.5, {}, 0, PF_CAMERA_EXACT,
                   PF_TIMESTAMPS_REAL, 0,      0,       0,    {}};
  config.capacity.max_state_dim = 64;
  config.capacity.max_features = 12;
  config.capacity.max_observations = 10;
  config.map.features_in_view = 8;
  pf_memory_t need;
  require(pf_memory_query(&config, &need) == PF_OK, "the config is right");
  void* block = nullptr;
  if (posix_memalign(&block, need.alignment < sizeof(void*) ? sizeof(void*) : need.alignment, need.bytes) != 0)
    return 0;
  pf_slam_t* slam = nullptr;
  require(pf_create(&config, block, need.bytes, &slam) == PF_OK, "a context is made");

  std::vector<uint8_t> pixels(static_cast<size_t>(kWidth) * kHeight);
  int64_t t_ns = 0;
  for (int steps = 0; steps < 40 && !bytes.empty(); ++steps) {
    const View before(slam);
    const pf_status_t status = step(slam, bytes, t_ns, pixels);
    require(pf_status_text(status) != nullptr, "every status has a text");
    const View after(slam);
    if (status < PF_OK) require(before == after, "what is refused changes nothing");
    if (after.status[1] >= PF_OK) {
      double sum = 0;
      for (double value : after.pose.covariance) sum += value;
      for (double value : after.pose.p_WC) sum += value;
      for (double value : after.pose.q_WC) sum += value;
      require(std::isfinite(sum), "a pose is finite");
    }
  }
  std::free(block);
  return 0;
}
