/* Inertial samples: hand them over as they come, and see what arrived.
 *
 * Samples belong before the frame whose time they reach up to. The library keeps the newest ones in a buffer of the size that
 * the config asks for and reports their rate, gaps and ends of range, so that wiring and clocks can be checked. Poses
 * depend on them with PF_MOTION_INERTIAL only (08_inertial.c). Here a unit at 200 Hz lies still, loses five samples, and
 * hits the end of its range once.
 */
#include <planefold/planefold.h>
#include <stdio.h>
#include <stdlib.h>

enum { SAMPLES = 400, LOST_FROM = 150, LOST = 5, BUFFER = 8 };

int main(void) {
  pf_config_t config;
  pf_memory_t need;
  pf_slam_t* slam;
  pf_imu_report_t report;
  pf_imu_sample_t kept[BUFFER];
  size_t count = 0;
  void* block;
  int i;

  pf_config_default(&config);
  config.camera.model = PF_CAMERA_PINHOLE;
  config.camera.width = 640;
  config.camera.height = 480;
  config.camera.fx = config.camera.fy = 500.0;
  config.camera.cx = 319.5;
  config.camera.cy = 239.5;
  config.capacity.max_imu_samples = BUFFER;
  config.imu.gyro_range = 35.0;
  config.imu.accel_range = 78.0;
  if (pf_memory_query(&config, &need) != PF_OK) {
    return 1;
  }
  block = malloc(need.bytes + need.alignment);
  if (block == NULL ||
      pf_create(&config, (char*)block + (need.alignment - (uintptr_t)block % need.alignment) % need.alignment,
                need.bytes, &slam) != PF_OK) {
    return 1;
  }
  for (i = 0; i < SAMPLES; ++i) {
    pf_imu_sample_t sample = {0};
    sample.t_ns = 1000000000 + (int64_t)i * 5000000;
    sample.accel[1] = -9.8; /* y points down: at rest the specific force points up */
    sample.gyro[2] = i == 300 ? 35.0 : 0.0;
    if (i >= LOST_FROM && i < LOST_FROM + LOST) {
      continue;
    }
    if (pf_push_imu(slam, &sample, 1) != PF_OK) {
      return 1;
    }
  }
  if (pf_get_imu_report(slam, &report) != PF_OK) {
    return 1;
  }
  printf("%lld samples, %.1f a second, one every %.1f ms\n", (long long)report.samples, report.rate_hz,
         1e3 * report.median_s);
  printf("%lld gap, %lld samples missing, longest interval %.1f ms\n", (long long)report.gaps,
         (long long)report.missing, 1e-6 * (double)report.longest_ns);
  printf("%lld at the end of the range\n", (long long)report.saturated);
  if (pf_get_imu_samples(slam, kept, BUFFER, &count) != PF_OK || count == 0) {
    return 1;
  }
  printf("the last of %d that are kept: t %.3f s, specific force %.1f m/s2\n", (int)count,
         1e-9 * (double)kept[count - 1].t_ns, kept[count - 1].accel[1]);
  free(block);
  return report.missing == LOST && report.saturated == 1 ? 0 : 1;
}
