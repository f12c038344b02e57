// The door for inertial samples: any numbers, in any order with frames and resets. All or none are taken, and what is kept is in order.
#include <planefold/planefold.h>

#include <cmath>
#include <cstdlib>
#include <vector>

#include "bytes.h"

namespace {

constexpr size_t kMost = 24;

pf_imu_report_t report_of(const pf_slam_t* slam) {
  pf_imu_report_t report;
  require(pf_get_imu_report(slam, &report) == PF_OK, "a context gives a report");
  return report;
}

void check_kept(const pf_slam_t* slam, size_t capacity) {
  std::vector<pf_imu_sample_t> kept(capacity + 1);
  size_t count = 0;
  require(pf_get_imu_samples(slam, kept.data(), kept.size(), &count) == PF_OK && count <= capacity,
          "what is kept fits");
  for (size_t i = 0; i < count; ++i) {
    require(i == 0 || kept[i - 1].t_ns < kept[i].t_ns, "what is kept is in order");
    for (int k = 0; k < 3; ++k)
      require(std::fabs(kept[i].gyro[k]) <= 1000.1 && std::fabs(kept[i].accel[k]) <= 1.001e5, "what is kept is sane");
  }
  const pf_imu_report_t report = report_of(slam);
  require(static_cast<size_t>(report.kept) == count && report.samples >= report.kept, "counts agree");
  require(report.gaps >= 0 && report.missing >= report.gaps && report.late >= 0 && report.longest_ns >= 0,
          "counts are counts");
  require(std::isfinite(report.rate_hz) && report.rate_hz >= 0 && report.median_s >= 0, "rates are rates");
}

void push(pf_slam_t* slam, Bytes& bytes, int64_t& t_ns) {
  pf_imu_sample_t samples[kMost];
  const uint8_t what = bytes.take<uint8_t>();
  const size_t count = bytes.take<uint8_t>() % (kMost + 1);
  for (size_t i = 0; i < count; ++i) {
    if ((what & 1) != 0 && bytes.take<uint8_t>() % 4 == 0) {
      bytes.take(&samples[i], sizeof(samples[i]));
      continue;
    }
    t_ns += int64_t{1} << (bytes.take<uint8_t>() % 40);
    samples[i] = {t_ns, {}, {}};
    for (int k = 0; k < 3; ++k) {
      samples[i].gyro[k] = bytes.take<int8_t>();
      samples[i].accel[k] = bytes.take<int16_t>();
    }
  }
  const int64_t before = report_of(slam).samples;
  const pf_status_t status = pf_push_imu(slam, samples, count);
  const int64_t taken = report_of(slam).samples - before;
  require(taken == (status == PF_OK ? static_cast<int64_t>(count) : 0), "all or none are taken");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Bytes bytes(data, size);
  pf_config_t config;
  pf_config_default(&config);
  config.camera = {PF_CAMERA_PINHOLE,  64, 48, 50.0, 50.0, 31.5, 23.5, {}, 0, PF_CAMERA_EXACT,
                   PF_TIMESTAMPS_REAL, 0,  0,  0,    {}};
  config.capacity.max_state_dim = 64;
  config.capacity.max_features = config.capacity.max_observations = config.map.features_in_view = 8;
  config.capacity.max_imu_samples = bytes.take<uint8_t>() % 20;
  config.imu.gyro_range = bytes.take<uint8_t>();
  config.imu.accel_range = bytes.take<uint8_t>();
  pf_memory_t need;
  require(pf_memory_query(&config, &need) == PF_OK, "the config is right");
  void* block = nullptr;
  if (posix_memalign(&block, need.alignment < sizeof(void*) ? sizeof(void*) : need.alignment, need.bytes) != 0)
    return 0;
  pf_slam_t* slam = nullptr;
  require(pf_create(&config, block, need.bytes, &slam) == PF_OK, "a context");
  int64_t t_ns = bytes.take<int64_t>() / 4, frame_ns = t_ns;
  while (!bytes.empty()) {
    const uint8_t what = bytes.take<uint8_t>();
    if (what % 8 == 0) {
      frame_ns += int64_t{1} << (what / 8);
      pf_push_observations(slam, frame_ns, nullptr, 0);
    } else if (what == 1) {
      pf_reset(slam);
    } else {
      push(slam, bytes, t_ns);
    }
    check_kept(slam, static_cast<size_t>(config.capacity.max_imu_samples));
  }
  std::free(block);
  return 0;
}
