/* The pose for the picture that is shown next.
 *
 * A frame takes time to arrive, to be processed and to be shown, and a renderer runs at its own rate. pf_predict_pose says
 * where the camera will be at the time of display, and how sure that is, as often as it is asked; the state does not change.
 * Here a camera circles with constant speed in front of a known target of twelve points, frames come at 30 per second, and the
 * renderer asks for poses 0, 20, 40 and 60 ms later: the further ahead, the larger the error, and the covariance says so.
 */
#include <math.h>
#include <planefold/planefold.h>
#include <stdio.h>
#include <stdlib.h>

enum { POINTS = 12, FRAMES = 90 };

static double random_number(void) {
  static uint64_t state = 3;
  state = state * 6364136223846793005u + 1442695040888963407u;
  return (double)(state >> 33) / 1073741824.0 - 1.0;
}

static void camera_at(double t, double p_W[3]) {
  p_W[0] = 0.25 * sin(1.5 * t);
  p_W[1] = 0.25 * cos(1.5 * t);
  p_W[2] = -1.0;
}

int main(void) {
  pf_config_t config;
  pf_memory_t need;
  pf_slam_t* slam;
  pf_target_t target = {0};
  double camera_W[3];
  double squares[4] = {0.0}, variances[4] = {0.0};
  int counts[4] = {0};
  void* block;
  int i, k, frame;

  pf_config_default(&config);
  config.camera.model = PF_CAMERA_PINHOLE;
  config.camera.width = 640;
  config.camera.height = 480;
  config.camera.fx = config.camera.fy = 500.0;
  config.camera.cx = 319.5;
  config.camera.cy = 239.5;
  config.measurement.sigma_px = 0.5;
  if (pf_memory_query(&config, &need) != PF_OK) {
    return 1;
  }
  block = malloc(need.bytes + need.alignment);
  if (block == NULL ||
      pf_create(&config, (char*)block + (need.alignment - (uintptr_t)block % need.alignment) % need.alignment,
                need.bytes, &slam) != PF_OK) {
    return 1;
  }
  /* The target: points on a wall at z = 0 and some before it, known to half a millimetre; the first pose is known to 2 cm
   * and 3 degrees. With a target of points, the observations 0 .. count-1 are its points. */
  target.kind = PF_TARGET_POINTS;
  target.count = POINTS;
  target.sigma = 0.0005;
  for (i = 0; i < POINTS; ++i) {
    target.points_W[i][0] = 0.35 * cos(6.2831853 * i / POINTS);
    target.points_W[i][1] = 0.25 * sin(6.2831853 * i / POINTS);
    target.points_W[i][2] = i % 3 == 0 ? -0.15 : 0.0;
  }
  camera_at(0.0, target.first_pose.p_WC);
  target.first_pose.q_WC[0] = 1.0;
  for (i = 0; i < 3; ++i) {
    target.first_pose.covariance[7 * i] = 0.05 * 0.05;
    target.first_pose.covariance[7 * (i + 3)] = 0.02 * 0.02;
  }
  if (pf_start_from_target(slam, &target) != PF_OK) {
    return 1;
  }
  for (frame = 0; frame < FRAMES; ++frame) {
    const double t = frame / 30.0;
    pf_observation_t seen[POINTS];
    camera_at(t, camera_W);
    for (i = 0; i < POINTS; ++i) {
      double p_C[3];
      for (k = 0; k < 3; ++k) {
        p_C[k] = target.points_W[i][k] - camera_W[k];
      }
      seen[i].id = (uint32_t)i;
      seen[i].sigma_px = 0.0;
      if (pf_camera_project(&config.camera, p_C, seen[i].pixel) != PF_OK) {
        return 1;
      }
      seen[i].pixel[0] += 0.87 * random_number();
      seen[i].pixel[1] += 0.87 * random_number();
    }
    if (pf_push_observations(slam, (int64_t)(1e9 * t), seen, POINTS) < 0) {
      return 1;
    }
    for (i = 0; i < 4 && frame >= 30; ++i) {
      const double ahead = 0.02 * i;
      pf_pose_t shown;
      if (pf_predict_pose(slam, (int64_t)(1e9 * (t + ahead)), &shown) != PF_OK) {
        continue;
      }
      camera_at(t + ahead, camera_W);
      for (k = 0; k < 3; ++k) {
        squares[i] += (shown.p_WC[k] - camera_W[k]) * (shown.p_WC[k] - camera_W[k]);
        variances[i] += shown.covariance[7 * (k + 3)];
      }
      ++counts[i];
    }
  }
  for (i = 0; i < 4; ++i) {
    if (counts[i] == 0) {
      return 1;
    }
    printf("%2d ms ahead: off by %.1f mm RMS, says +- %.1f mm\n", 20 * i, 1e3 * sqrt(squares[i] / counts[i]),
           1e3 * sqrt(variances[i] / counts[i]));
  }
  free(block);
  return 0;
}
