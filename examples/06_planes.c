/* Planes: which there are, what lies under a pixel, and which of them is a floor.
 *
 * Points of two surfaces in front of the camera, a wall and a floor, are projected by this program in place of images. The
 * library finds the planes that they lie on. A program that places things in the scene asks for the plane under a pixel
 * (pf_hit_test), keeps the id and where that was, and draws it in later frames (pf_project_point); when planes turn out to be
 * one, pf_find_plane follows the id. With the direction of gravity known, planes are told apart: floors, ceilings, walls.
 */
#include <math.h>
#include <planefold/planefold.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TARGET = 4, POINTS = 52, FRAMES = 200, MAX_PLANES = 8 };

static const char* const orientation_name[] = {"unknown", "floor or table", "ceiling", "wall", "slanted"};

/* Uniform in -1 .. 1; the same numbers in every run. */
static double random_number(void) {
  static uint64_t state = 1;
  state = state * 6364136223846793005u + 1442695040888963407u;
  return (double)(state >> 33) / 1073741824.0 - 1.0;
}

/* Four known points give the scale; the others lie on the wall (z = 2) and on the floor (y = 0.8, y points down). */
static void make_scene(double points_W[POINTS][3], pf_target_t* target) {
  int i, k;
  memset(target, 0, sizeof *target);
  target->kind = PF_TARGET_POINTS;
  target->count = TARGET;
  target->sigma = 0.001;
  target->first_pose.q_WC[0] = 1.0;
  for (i = 0; i < 6; ++i) {
    target->first_pose.covariance[7 * i] = 1e-4;
  }
  for (i = 0; i < POINTS; ++i) {
    points_W[i][0] = i < TARGET ? 0.3 * (i % 2 ? 1 : -1) : random_number();
    points_W[i][1] = i < TARGET ? 0.3 * (i / 2 ? 1 : -1) : i % 2 ? 0.7 * random_number() : 0.8;
    points_W[i][2] = i < TARGET ? 1.4 + 0.1 * i : i % 2 ? 2.0 : 1.6 + 0.3 * random_number();
    for (k = 0; k < 3 && i < TARGET; ++k) {
      target->points_W[i][k] = points_W[i][k];
    }
  }
}

static size_t look(const pf_camera_t* camera, double points_W[POINTS][3], double t, pf_observation_t* seen) {
  const double camera_W[3] = {0.4 * sin(t), 0.1 * sin(2.0 * t), 0.15 * (1.0 - cos(t))};
  size_t count = 0;
  int i;
  for (i = 0; i < POINTS; ++i) {
    const double p_C[3] = {points_W[i][0] - camera_W[0], points_W[i][1] - camera_W[1], points_W[i][2] - camera_W[2]};
    double pixel[2];
    if (pf_camera_project(camera, p_C, pixel) == PF_OK && pixel[0] > 0.0 && pixel[0] < 639.0 && pixel[1] > 0.0 &&
        pixel[1] < 479.0) {
      seen[count].id = (uint32_t)i;
      seen[count].pixel[0] = pixel[0] + 0.5 * random_number();
      seen[count].pixel[1] = pixel[1] + 0.5 * random_number();
      seen[count].sigma_px = 0.3;
      ++count;
    }
  }
  return count;
}

int main(void) {
  const double gravity_W[3] = {0.0, 9.81, 0.0}; /* y points down */
  const double touched[2] = {380.0, 200.0};
  pf_config_t config;
  pf_memory_t need;
  pf_slam_t* slam;
  pf_target_t target;
  pf_state_t state = PF_STATE_STARTING;
  pf_plane_t planes[MAX_PLANES];
  pf_hit_t hit;
  pf_observation_t seen[POINTS];
  double points_W[POINTS][3], pixel[2];
  size_t count = 0, i;
  uint32_t now = 0;
  void* block;
  int frame;

  pf_config_default(&config);
  config.camera.model = PF_CAMERA_PINHOLE;
  config.camera.width = 640;
  config.camera.height = 480;
  config.camera.fx = config.camera.fy = 400.0;
  config.camera.cx = 319.5;
  config.camera.cy = 239.5;
  make_scene(points_W, &target);
  if (pf_memory_query(&config, &need) != PF_OK) {
    return 1;
  }
  block = malloc(need.bytes + need.alignment);
  if (block == NULL ||
      pf_create(&config, (char*)block + (need.alignment - (uintptr_t)block % need.alignment) % need.alignment,
                need.bytes, &slam) != PF_OK ||
      pf_start_from_target(slam, &target) != PF_OK || pf_set_gravity(slam, gravity_W) != PF_OK) {
    return 1;
  }
  for (frame = 0; frame < FRAMES; ++frame) {
    const double t = frame / 30.0;
    if (pf_push_observations(slam, (int64_t)(1e9 * t), seen, look(&config.camera, points_W, t, seen)) < 0) {
      return 1;
    }
  }
  if (pf_get_state(slam, &state) != PF_OK || state != PF_STATE_TRACKING) {
    return 1;
  }
  if (pf_get_planes(slam, planes, MAX_PLANES, &count) < 0) {
    return 1;
  }
  for (i = 0; i < count && i < MAX_PLANES; ++i) {
    printf("plane %u: %s, %d points, %.2f m2, normal %5.2f %5.2f %5.2f +- %.1f mrad\n", planes[i].id,
           orientation_name[planes[i].orientation], planes[i].points, planes[i].area, planes[i].normal_W[0],
           planes[i].normal_W[1], planes[i].normal_W[2], 1e3 * sqrt(planes[i].covariance[0] + planes[i].covariance[4]));
  }
  if (pf_hit_test(slam, touched, &hit) != PF_OK) {
    return 1;
  }
  printf("under pixel (%.0f, %.0f): plane %u at %.3f %.3f %.3f +- %.1f mm, %.2f m away\n", touched[0], touched[1],
         hit.plane, hit.p_W[0], hit.p_W[1], hit.p_W[2],
         1e3 * sqrt(hit.covariance[0] + hit.covariance[4] + hit.covariance[8]), hit.range);

  /* Half a second later: is the plane still there, and where is that place in the picture? */
  for (; frame < FRAMES + 15; ++frame) {
    const double t = frame / 30.0;
    if (pf_push_observations(slam, (int64_t)(1e9 * t), seen, look(&config.camera, points_W, t, seen)) < 0) {
      return 1;
    }
  }
  if (pf_find_plane(slam, hit.plane, &now) != PF_OK || pf_project_point(slam, hit.p_W, pixel, NULL) != PF_OK) {
    return 1;
  }
  printf("half a second later: on plane %u, at pixel (%.1f, %.1f)\n", now, pixel[0], pixel[1]);
  free(block);
  return count == 2 ? 0 : 1;
}
