/* Observations from your own tracker.
 *
 * Where something else finds and recognises features (a camera with a tracker in hardware, markers, a simulation), the
 * library takes their pixels instead of images: pf_push_observations. A number that is new begins a feature, a known one
 * measures it again. Here forty points in front of the camera are projected by this program, with half a pixel of noise, while
 * the camera moves along a known path from a known first pose, so that the estimate can be held against the truth. Pixels
 * alone do not measure the scale: here only the rough first speed and depth constrain it, and the covariance shows how little.
 */
#include <math.h>
#include <planefold/planefold.h>
#include <stdio.h>
#include <stdlib.h>

enum { POINTS = 40, FRAMES = 120 };

/* Uniform in -1 .. 1; the same numbers in every run. */
static double random_number(void) {
  static uint64_t state = 1;
  state = state * 6364136223846793005u + 1442695040888963407u;
  return (double)(state >> 33) / 1073741824.0 - 1.0;
}

int main(void) {
  pf_config_t config;
  pf_memory_t need;
  pf_slam_t* slam;
  pf_pose_t pose = {0};
  double velocity_covariance[36] = {0};
  double points_W[POINTS][3];
  void* block;
  int i, frame, done = 0;

  pf_config_default(&config);
  config.camera.model = PF_CAMERA_PINHOLE;
  config.camera.width = 640;
  config.camera.height = 480;
  config.camera.fx = config.camera.fy = 500.0;
  config.camera.cx = 319.5;
  config.camera.cy = 239.5;
  config.measurement.sigma_px = 0.5;
  config.first_depth.depth = 2.0; /* metres: about what the points are away */

  if (pf_memory_query(&config, &need) != PF_OK) {
    return 1;
  }
  block = malloc(need.bytes + need.alignment);
  if (block == NULL ||
      pf_create(&config, (char*)block + (need.alignment - (uintptr_t)block % need.alignment) % need.alignment,
                need.bytes, &slam) != PF_OK) {
    return 1;
  }
  for (i = 0; i < POINTS; ++i) {
    points_W[i][0] = 1.2 * random_number();
    points_W[i][1] = 0.9 * random_number();
    points_W[i][2] = 2.0 + 0.8 * random_number();
  }
  /* The first pose is known to a millimetre and a twentieth of a degree, the first speed to 0.1 m/s and 0.1 rad/s. */
  pose.q_WC[0] = 1.0;
  for (i = 0; i < 3; ++i) {
    pose.covariance[7 * i] = 1e-6;
    pose.covariance[7 * (i + 3)] = 1e-6;
    velocity_covariance[7 * i] = velocity_covariance[7 * (i + 3)] = 0.01;
  }
  if (pf_start_from_pose(slam, &pose, velocity_covariance) != PF_OK) {
    return 1;
  }
  for (frame = 0; frame < FRAMES; ++frame) {
    const double t = frame / 30.0;
    const double camera_W[3] = {0.3 * sin(t), 0.1 * sin(2.0 * t), 0.2 * (1.0 - cos(t))};
    pf_observation_t seen[POINTS];
    size_t count = 0;
    pf_status_t status;
    for (i = 0; i < POINTS; ++i) {
      const double p_C[3] = {points_W[i][0] - camera_W[0], points_W[i][1] - camera_W[1], points_W[i][2] - camera_W[2]};
      double pixel[2];
      if (pf_camera_project(&config.camera, p_C, pixel) == PF_OK && pixel[0] > 0.0 && pixel[0] < 639.0 &&
          pixel[1] > 0.0 && pixel[1] < 479.0) {
        seen[count].id = (uint32_t)i;
        seen[count].pixel[0] = pixel[0] + 0.87 * random_number(); /* uniform, of standard deviation 0.5 */
        seen[count].pixel[1] = pixel[1] + 0.87 * random_number();
        seen[count].sigma_px = 0.0;
        ++count;
      }
    }
    status = pf_push_observations(slam, (int64_t)(1e9 * t), seen, count);
    if (status < 0) {
      fprintf(stderr, "frame %d: %s\n", frame, pf_status_text(status));
      return 1;
    }
    if (frame % 20 == 19 && pf_get_pose(slam, &pose) == PF_OK) {
      const double dx = pose.p_WC[0] - camera_W[0], dy = pose.p_WC[1] - camera_W[1], dz = pose.p_WC[2] - camera_W[2];
      const double sigma = sqrt(pose.covariance[21] + pose.covariance[28] + pose.covariance[35]);
      printf("t %.2f s  off by %4.1f mm, says +- %4.1f mm  (%s)\n", t, 1e3 * sqrt(dx * dx + dy * dy + dz * dz),
             1e3 * sigma, pf_status_text(status));
      done = status == PF_OK;
    }
  }
  free(block);
  return done ? 0 : 1;
}
