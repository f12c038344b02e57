/* Metres from a hand's motion, in the window.
 *
 * The same samples as in 08_inertial.c give the window (PF_BACKEND_WINDOW) its unit of length while the camera moves: its map
 * begins with the median depth as unit, and after some seconds of motion it goes on in metres, under another map_id. A tracker
 * of its own follows 150 points here; the hand moves by 20 cm and rotates by a few degrees. What can go wrong with a unit of
 * which little is known: lib/docs/guide/unknown_unit.md.
 */
#include <math.h>
#include <planefold/planefold.h>
#include <stdio.h>
#include <stdlib.h>

enum { POINTS = 150, FRAMES = 300 };

static const double kFocal = 500.0, kRate = 2.6, kTurn = 0.08;

/* Where the camera is, and by which angle it is rotated about its vertical axis. */
static void path(double t, double p[3], double* angle) {
  p[0] = 0.2 * sin(kRate * t);
  p[1] = 0.1 * sin(1.3 * kRate * t);
  p[2] = 0.1 * (1.0 - cos(kRate * t));
  *angle = kTurn * sin(0.7 * kRate * t);
}

/* What the unit, which is where the camera is and has its axes, reads at t. */
static pf_imu_sample_t reading(double t) {
  const double h = 1e-4;
  double before[3], now[3], after[3], angle[3], f[3];
  pf_imu_sample_t sample = {0};
  int a;
  path(t - h, before, &angle[0]);
  path(t, now, &angle[1]);
  path(t + h, after, &angle[2]);
  for (a = 0; a < 3; ++a) f[a] = (before[a] - 2.0 * now[a] + after[a]) / (h * h);
  f[1] -= 9.81; /* y points down */
  sample.t_ns = (int64_t)floor(1e9 * t + 0.5);
  sample.gyro[1] = (angle[2] - angle[0]) / (2.0 * h);
  sample.accel[0] = cos(angle[1]) * f[0] - sin(angle[1]) * f[2];
  sample.accel[1] = f[1];
  sample.accel[2] = sin(angle[1]) * f[0] + cos(angle[1]) * f[2];
  return sample;
}

static double fraction(uint32_t* random) {
  *random = 1664525u * *random + 1013904223u;
  return (double)(*random >> 8) / (1 << 24);
}

/* Pixels of the points that the camera sees at t. */
static size_t look(double t, pf_observation_t seen[POINTS]) {
  double p[3], angle;
  uint32_t random = 7;
  size_t count = 0, i;
  path(t, p, &angle);
  for (i = 0; i < POINTS; ++i) {
    const double x = 5.0 * fraction(&random) - 2.5 - p[0], y = 3.0 * fraction(&random) - 1.5 - p[1];
    const double z = 2.0 + 2.0 * fraction(&random) - p[2];
    const double x_C = cos(angle) * x - sin(angle) * z, z_C = sin(angle) * x + cos(angle) * z;
    const double u = 319.5 + kFocal * x_C / z_C + fraction(&random) - 0.5;
    const double v = 239.5 + kFocal * y / z_C + fraction(&random) - 0.5;
    if (u < 10.0 || v < 10.0 || u > 629.0 || v > 469.0) continue;
    seen[count].id = (uint32_t)i;
    seen[count].pixel[0] = u;
    seen[count].pixel[1] = v;
    seen[count++].sigma_px = 0.3;
  }
  return count;
}

int main(void) {
  pf_config_t config;
  pf_memory_t need;
  pf_slam_t* slam;
  pf_inertial_t unit = {0};
  pf_observation_t seen[POINTS];
  pf_pose_t pose = {0};
  double p[3], angle, at_s = -1.0, off = 0.0;
  void* block;
  int k, next = 0;

  pf_config_default(&config);
  config.backend = PF_BACKEND_WINDOW;
  config.camera.model = PF_CAMERA_PINHOLE;
  config.camera.width = 640;
  config.camera.height = 480;
  config.camera.fx = config.camera.fy = kFocal;
  config.camera.cx = 319.5;
  config.camera.cy = 239.5;
  config.motion.model = PF_MOTION_INERTIAL;
  config.capacity.max_imu_samples = 400;
  config.imu.gyro_density = 1.7e-4;
  config.imu.accel_density = 2e-3;
  config.imu.gyro_walk = 2e-5;
  config.imu.accel_walk = 3e-3;
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
    const double t = k / 30.0;
    for (; next / 200.0 <= t + 0.005; ++next) {
      const pf_imu_sample_t sample = reading(next / 200.0);
      if (pf_push_imu(slam, &sample, 1) != PF_OK) {
        return 1;
      }
    }
    if (pf_push_observations(slam, (int64_t)floor(1e9 * t + 0.5), seen, look(t, seen)) < PF_OK) {
      return 1;
    }
    if (at_s < 0.0 && pf_get_inertial(slam, &unit) == PF_OK && unit.metric != 0) {
      at_s = t;
    }
  }
  if (at_s < 0.0 || pf_get_pose(slam, &pose) != PF_OK || pf_get_inertial(slam, &unit) != PF_OK) {
    printf("lengths are not known\n");
    return 1;
  }
  path((FRAMES - 1) / 30.0, p, &angle);
  for (k = 0; k < 3; ++k) off += (pose.p_WC[k] - p[k]) * (pose.p_WC[k] - p[k]);
  printf("metres after %.1f s of motion; the scale is known to %.1f %%\n", at_s, 100.0 * unit.sigma.log_scale);
  printf("gravity in W %.2f %.2f %.2f m/s2\n", unit.gravity_W[0], unit.gravity_W[1], unit.gravity_W[2]);
  printf("after %.0f s the camera is %.1f cm from where it should be, in map %lu\n", FRAMES / 30.0, 100.0 * sqrt(off),
         (unsigned long)pose.map_id);
  free(block);
  return off < 0.03 * 0.03 ? 0 : 1;
}
