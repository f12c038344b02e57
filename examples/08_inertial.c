/* An inertial unit from rest: metres and gravity with nothing else known.
 *
 * With PF_MOTION_INERTIAL the samples of pf_push_imu move the camera. Hold it still for a second at first: that measures the
 * direction of gravity and the bias of the gyroscope, and from then on lengths are metres. Here a tracker of its own follows 24 points
 * while the unit lies still at 200 Hz; the config says how noisy the unit is, which only you know (lib/docs/theory/inertial.md).
 */
#include <math.h>
#include <planefold/planefold.h>
#include <stdio.h>
#include <stdlib.h>

enum { POINTS = 24, FRAMES = 60 };

static const int64_t FRAME_NS = 33333333, SAMPLE_NS = 5000000;

int main(void) {
  pf_config_t config;
  pf_memory_t need;
  pf_slam_t* slam;
  pf_inertial_t unit = {0};
  pf_observation_t seen[POINTS];
  int64_t sample_ns = 0;
  void* block;
  int i, k;

  pf_config_default(&config);
  config.camera.model = PF_CAMERA_PINHOLE;
  config.camera.width = 640;
  config.camera.height = 480;
  config.camera.fx = config.camera.fy = 500.0;
  config.camera.cx = 319.5;
  config.camera.cy = 239.5;
  config.motion.model = PF_MOTION_INERTIAL;
  config.capacity.max_imu_samples = 400; /* two seconds: the longest time between frames that is bridged */
  config.imu.gyro_density = 1.7e-4;
  config.imu.accel_density = 2e-3;
  config.imu.gyro_walk = 2e-5;
  config.imu.accel_walk = 3e-3;
  config.imu.p_BC[0] = 0.05; /* the camera is 5 cm beside the unit, with the same axes */
  if (pf_memory_query(&config, &need) != PF_OK) {
    return 1;
  }
  block = malloc(need.bytes + need.alignment);
  if (block == NULL ||
      pf_create(&config, (char*)block + (need.alignment - (uintptr_t)block % need.alignment) % need.alignment,
                need.bytes, &slam) != PF_OK) {
    return 1;
  }
  for (k = 0; k < FRAMES; ++k) {
    const int64_t t_ns = k * FRAME_NS;
    for (; sample_ns <= t_ns; sample_ns += SAMPLE_NS) {
      pf_imu_sample_t sample = {0};
      sample.t_ns = sample_ns;
      sample.gyro[0] = 0.01;   /* what this gyro reads when nothing turns */
      sample.accel[1] = -9.81; /* y points down: at rest the specific force points up */
      if (pf_push_imu(slam, &sample, 1) != PF_OK) {
        return 1;
      }
    }
    for (i = 0; i < POINTS; ++i) {
      seen[i].id = (uint32_t)i;
      seen[i].pixel[0] = 80.0 + 90.0 * (i % 6);
      seen[i].pixel[1] = 60.0 + 100.0 * (double)(i / 6);
      seen[i].sigma_px = 0.5;
    }
    if (pf_push_observations(slam, t_ns, seen, POINTS) < PF_OK) {
      return 1;
    }
    if (pf_get_inertial(slam, &unit) == PF_OK && unit.metric != 0) {
      break;
    }
  }
  printf("after %d frames at rest: lengths are %s\n", k, unit.metric ? "metres" : "not known");
  printf("gravity in W %.2f %.2f %.2f m/s2, gyro bias %.4f %.4f %.4f rad/s\n", unit.gravity_W[0], unit.gravity_W[1],
         unit.gravity_W[2], unit.gyro_bias[0], unit.gyro_bias[1], unit.gyro_bias[2]);
  printf("sigma of its direction %.2f degrees: what the accelerometer's bias leaves open\n",
         57.3 * sqrt(unit.covariance[0]));
  free(block);
  return unit.metric != 0 && unit.gravity_W[1] > 9.8 ? 0 : 1;
}
