/* Walls of a building plan: a plan that is roughly right, and pictures that say how it really is.
 *
 * Two textured walls meet in a corner. The program draws them as a moving camera sees them, and adds both
 * with pf_add_wall as a plan has them: wrong by some degrees and centimetres, with standard deviations of that size. The
 * first pose is known (pf_start_from_pose), since a plan is of use only in its own frame. Room for patches
 * (capacity.max_patches) lets whole pieces of a wall be followed beside points. In the end the program prints how far the
 * walls are from the truth, in the plan and as the library has them now with their standard deviations, and how far the
 * camera is. lib/docs/theory/walls.md says what a wall may be, and lib/docs/theory/servant2008.md where this comes from.
 */
#include <math.h>
#include <planefold/planefold.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 320, HEIGHT = 240, FRAMES = 150, WALLS = 2, MAX_PATCHES = 8, MAX_PLANES = 16 };

static const double kFocal = 280.0, kDegree = 3.14159265358979 / 180.0;
static uint8_t pixels[HEIGHT][WIDTH];

/* A wall that stands upright: its middle, the angle about the vertical (0: it faces the camera), half its width and height. */
typedef struct upright {
  double middle_W[3], angle, half_width, half_height;
} upright_t;

static const upright_t truth[WALLS] = {{{-0.2, 0.0, 3.0}, 0.0, 2.0, 1.5}, {{1.8, 0.0, 1.75}, 1.5707963268, 1.25, 1.5}};
/* Of the plan: degrees about the vertical, metres along the normal. */
static const double plan_angle[WALLS] = {4.0, -3.0}, plan_offset[WALLS] = {0.05, -0.04};

/* Axes of a wall: x along it, y up, z towards the side that is seen (y of the world points down). */
static void axes_of(const upright_t* wall, double x[3], double y[3], double z[3]) {
  x[0] = cos(wall->angle), x[1] = 0.0, x[2] = -sin(wall->angle);
  y[0] = 0.0, y[1] = -1.0, y[2] = 0.0;
  z[0] = -sin(wall->angle), z[1] = 0.0, z[2] = -cos(wall->angle);
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Grey level of a cell of a pattern, by a hash of its numbers. */
static double grey_of(int i, int j) {
  uint32_t h = (uint32_t)i * 0x9e3779b1u ^ (uint32_t)j * 0x85ebca77u;
  h = (h ^ h >> 15) * 0x2c1b3c6du;
  return 40.0 + (double)((h ^ h >> 12) % 176u);
}

/* The pattern between its cells: squares with edges that are a third of a cell wide. */
static double pattern(double u, double v) {
  const int i = (int)floor(u), j = (int)floor(v);
  const double x = fmin(1.0, 3.0 * (u - i)), y = fmin(1.0, 3.0 * (v - j));
  return (1.0 - y) * ((1.0 - x) * grey_of(i - 1, j - 1) + x * grey_of(i, j - 1)) +
         y * ((1.0 - x) * grey_of(i - 1, j) + x * grey_of(i, j));
}

/* Where the camera is after t seconds, and how far it has turned to the right. */
static double place_at(double t, double p_W[3]) {
  p_W[0] = 0.5 * sin(0.8 * t);
  p_W[1] = 0.1 * sin(1.3 * t);
  p_W[2] = 0.2 * (1.0 - cos(0.7 * t));
  return 0.25 + 0.15 * sin(0.5 * t);
}

static void draw(double t) {
  double p_W[3], x_W[3], y_W[3], z_W[3], ray_W[3], way_W[3];
  const double turn = place_at(t, p_W);
  int x, y, k, i;
  for (y = 0; y < HEIGHT; ++y) {
    for (x = 0; x < WIDTH; ++x) {
      const double rx = (x - 159.5) / kFocal, ry = (y - 119.5) / kFocal;
      double nearest = 1e9, grey = 20.0;
      ray_W[0] = cos(turn) * rx + sin(turn);
      ray_W[1] = ry;
      ray_W[2] = cos(turn) - sin(turn) * rx;
      for (k = 0; k < WALLS; ++k) {
        double range, u, v;
        axes_of(&truth[k], x_W, y_W, z_W);
        for (i = 0; i < 3; ++i) way_W[i] = truth[k].middle_W[i] - p_W[i];
        range = dot(z_W, way_W) / dot(z_W, ray_W);
        if (!(range > 0.1 && range < nearest)) continue;
        for (i = 0; i < 3; ++i) way_W[i] -= range * ray_W[i];
        u = -dot(x_W, way_W);
        v = -dot(y_W, way_W);
        if (fabs(u) > truth[k].half_width || fabs(v) > truth[k].half_height) continue;
        nearest = range;
        grey = pattern(5.0 * u + 100.0 * (k + 1), 5.0 * v + 100.0);
      }
      pixels[y][x] = (uint8_t)grey;
    }
  }
}

/* What the plan says of a wall, and how well it knows it: 3 degrees about the vertical, 1 degree out of it, 5 cm. */
static void take_from_plan(int k, pf_wall_prior_t* wall) {
  upright_t planned = truth[k];
  double x[3], y[3], z[3];
  int i;
  planned.angle += plan_angle[k] * kDegree;
  axes_of(&planned, x, y, z);
  memset(wall, 0, sizeof *wall);
  for (i = 0; i < 3; ++i) {
    wall->R_WP[3 * i] = x[i];
    wall->R_WP[3 * i + 1] = y[i];
    wall->R_WP[3 * i + 2] = z[i];
    wall->p_WP[i] = planned.middle_W[i] + plan_offset[k] * z[i];
  }
  wall->covariance[0] = pow(3.0 * kDegree, 2.0); /* n + alpha x: a turn about the vertical */
  wall->covariance[4] = pow(1.0 * kDegree, 2.0);
  wall->covariance[8] = pow(0.05, 2.0);
  wall->outline_count = 4;
  for (i = 0; i < 4; ++i) {
    wall->outline_P[i][0] = planned.half_width * (i == 1 || i == 2 ? 1.0 : -1.0);
    wall->outline_P[i][1] = planned.half_height * (i >= 2 ? 1.0 : -1.0);
  }
}

/* Angle between the normals [degrees], and distance at the true middle [m]. */
static void compare(int k, const double normal_W[3], double distance, double* angle, double* offset) {
  double x[3], y[3], z[3];
  axes_of(&truth[k], x, y, z);
  *angle = acos(fmin(1.0, dot(normal_W, z))) / kDegree;
  *offset = fabs(dot(normal_W, truth[k].middle_W) - distance);
}

int main(void) {
  pf_wall_prior_t plan[WALLS];
  uint32_t id[WALLS];
  pf_config_t config;
  pf_memory_t need;
  pf_slam_t* slam;
  pf_pose_t pose = {0};
  pf_patch_t patches[MAX_PATCHES];
  pf_plane_t planes[MAX_PLANES];
  double velocities[36] = {0}, p_W[3], turn, angle, offset;
  size_t count = 0, measured = 0, k;
  int frame, i, good = 0;
  void* block;

  pf_config_default(&config);
  config.camera.model = PF_CAMERA_PINHOLE;
  config.camera.width = WIDTH;
  config.camera.height = HEIGHT;
  config.camera.fx = config.camera.fy = kFocal;
  config.camera.cx = 159.5;
  config.camera.cy = 119.5;
  config.capacity.max_patches = MAX_PATCHES;
  config.capacity.patch_side_px = 64;
  if (pf_memory_query(&config, &need) != PF_OK) {
    return 1;
  }
  block = malloc(need.bytes + need.alignment);
  if (block == NULL ||
      pf_create(&config, (char*)block + (need.alignment - (uintptr_t)block % need.alignment) % need.alignment,
                need.bytes, &slam) != PF_OK) {
    return 1;
  }

  /* Where the camera is at first: to 5 mm and half a degree; its velocities to what a hand does. */
  turn = place_at(0.0, pose.p_WC);
  pose.q_WC[0] = cos(0.5 * turn);
  pose.q_WC[2] = sin(0.5 * turn);
  for (i = 0; i < 6; ++i) {
    pose.covariance[7 * i] = pow(i < 3 ? 0.5 * kDegree : 0.005, 2.0);
    velocities[7 * i] = 0.25;
  }
  if (pf_start_from_pose(slam, &pose, velocities) != PF_OK) {
    return 1;
  }
  for (i = 0; i < WALLS; ++i) {
    take_from_plan(i, &plan[i]);
    if (pf_add_wall(slam, &plan[i], &id[i]) != PF_OK) {
      return 1;
    }
  }

  for (frame = 0; frame < FRAMES; ++frame) {
    const double t = frame / 30.0;
    const pf_image_t image = {&pixels[0][0], WIDTH, HEIGHT, WIDTH, 1000000000 + (int64_t)(1e9 * t)};
    draw(t);
    if (pf_push_frame(slam, &image) < PF_OK || pf_get_patches(slam, patches, MAX_PATCHES, &count) < PF_OK) {
      return 1;
    }
    for (k = 0; k < count && k < MAX_PATCHES; ++k) {
      measured += (size_t)(patches[k].status == PF_MATCH_INLIER);
    }
  }

  if (pf_get_planes(slam, planes, MAX_PLANES, &count) < PF_OK || pf_get_pose(slam, &pose) < PF_OK) {
    return 1;
  }
  for (i = 0; i < WALLS; ++i) {
    const double* R = plan[i].R_WP;
    const double normal[3] = {R[2], R[5], R[8]};
    compare(i, normal, dot(normal, plan[i].p_WP), &angle, &offset);
    printf("wall %d in the plan: %.2f degrees and %2.0f mm off\n", i + 1, angle, 1e3 * offset);
    for (k = 0; k < count && k < MAX_PLANES; ++k) {
      if (planes[k].id != id[i]) {
        continue;
      }
      compare(i, planes[k].normal_W, planes[k].distance, &angle, &offset);
      printf("  now: %.2f degrees (sigma %.2f) and %.0f mm (sigma %.0f), with %d points\n", angle,
             sqrt(planes[k].covariance[0]) / kDegree, 1e3 * offset, 1e3 * sqrt(planes[k].covariance[8]),
             planes[k].points);
      good += angle < 0.25 * fabs(plan_angle[i]);
    }
  }
  place_at((FRAMES - 1) / 30.0, p_W);
  for (i = 0; i < 3; ++i) {
    p_W[i] -= pose.p_WC[i];
  }
  printf("%.1f patches measured in a frame; the camera is %.0f mm off (sigma %.0f)\n", (double)measured / FRAMES,
         1e3 * sqrt(dot(p_W, p_W)), 1e3 * sqrt(pose.covariance[21] + pose.covariance[28] + pose.covariance[35]));
  free(block);
  return good == WALLS ? 0 : 1;
}
