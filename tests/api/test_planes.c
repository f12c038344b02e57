/* Planes as a caller sees them, on simulated walls whose truth is known: found, outlined, hit by rays, merged, told from floors. */
#include <math.h>
#include <planefold/planefold.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#define MAX_POINTS 80
#define TARGET_POINTS 9
#define SIGMA_PX 0.3
#define NIS_3_DOF 16.3 /* chi-squared with 3 degrees of freedom, 99.9 % */

/* n . p = d, n towards the camera. */
typedef struct wall {
  double normal[3], distance;
} wall_t;

static const wall_t front = {{0, 0, -1}, -2.0};  /* z = 2 */
static const wall_t floor_ = {{0, -1, 0}, -0.9}; /* y = 0.9, y points down */

static pf_config_t config;
static unsigned char* raw;
static pf_slam_t* slam;
static double points_W[MAX_POINTS][3];
static int count;
static int merges;
static uint64_t random_state;
static double camera_W[3]; /* where it truly is; it does not rotate */

static double uniform(void) {
  random_state = random_state * 6364136223846793005u + 1442695040888963407u;
  return ((double)(random_state >> 33) + 0.5) / 2147483648.0;
}

static double normal(void) { return sqrt(-2 * log(uniform())) * cos(6.283185307179586 * uniform()); }

static void on_log(void* user, const char* line) {
  (void)user;
  merges += strstr(line, " merged into ") != NULL;
}

void setUp(void) {
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config));
  const pf_camera_t camera = {PF_CAMERA_PINHOLE,  640, 480, 400, 400, 319.5, 239.5, {0}, 0, PF_CAMERA_EXACT,
                              PF_TIMESTAMPS_REAL, 0,   0,   0,   {0}};
  config.camera = camera;
  config.measurement.sigma_px = SIGMA_PX;
  config.capacity.max_observations = MAX_POINTS;
  config.first_depth.depth = 2;
  config.plane.roughness = 1e-4; /* these walls are flat */
  config.log = on_log;
  random_state = 7;
  merges = 0;
  count = 0;
  raw = NULL;
}

void tearDown(void) { free(raw); }

static void add_point(double x, double y, double z) {
  TEST_ASSERT_TRUE(count < MAX_POINTS);
  points_W[count][0] = x;
  points_W[count][1] = y;
  points_W[count][2] = z;
  ++count;
}

/* The first points are those of a target, in front of the wall and not in one plane. */
static void add_target(void) {
  for (int i = 0; i < TARGET_POINTS; ++i) add_point(-0.3 + 0.3 * (i % 3), -0.3 + 0.3 * (i / 3), 1.5 + 0.07 * (i % 4));
}

static void create(void) {
  pf_memory_t need;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
  raw = (unsigned char*)malloc(need.bytes + need.alignment);
  TEST_ASSERT_NOT_NULL(raw);
  unsigned char* block = raw + (need.alignment - (uintptr_t)raw % need.alignment) % need.alignment;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, need.bytes, &slam));
  pf_target_t target;
  memset(&target, 0, sizeof target);
  target.kind = PF_TARGET_POINTS;
  target.count = TARGET_POINTS;
  memcpy(target.points_W, points_W, TARGET_POINTS * sizeof *points_W);
  target.first_pose.q_WC[0] = 1;
  for (int i = 0; i < 6; ++i) target.first_pose.covariance[7 * i] = 1e-4;
  target.sigma = 0.001;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_target(slam, &target));
}

/* Frame k: the camera sways sideways, up and down and forward, and sees every point that is in its image. */
static void push(int k) {
  const double t = k / 30.0;
  camera_W[0] = 0.4 * sin(t);
  camera_W[1] = 0.2 * sin(1.7 * t);
  camera_W[2] = 0.15 * (1 - cos(1.3 * t));
  pf_observation_t seen[MAX_POINTS];
  size_t number = 0;
  for (int i = 0; i < count; ++i) {
    const double p_C[3] = {points_W[i][0] - camera_W[0], points_W[i][1] - camera_W[1], points_W[i][2] - camera_W[2]};
    pf_observation_t* o = &seen[number];
    if (pf_camera_project(&config.camera, p_C, o->pixel) != PF_OK) continue;
    if (o->pixel[0] < 0 || o->pixel[0] > 639 || o->pixel[1] < 0 || o->pixel[1] > 479) continue;
    o->pixel[0] += SIGMA_PX * normal();
    o->pixel[1] += SIGMA_PX * normal();
    o->id = (uint32_t)i;
    o->sigma_px = 0;
    ++number;
  }
  TEST_ASSERT_TRUE(pf_push_observations(slam, (int64_t)(1e9 * t) + 1, seen, number) >= PF_OK);
}

static void add_front_and_floor(void) {
  add_target();
  for (int i = 0; i < 30; ++i) add_point(-1.1 + 2.2 * uniform(), -0.9 + 1.6 * uniform(), 2.0);
  for (int i = 0; i < 24; ++i) add_point(-0.8 + 1.6 * uniform(), 0.9, 1.75 - 0.4 * uniform());
}

static size_t all_planes(pf_plane_t* planes, size_t capacity) {
  size_t number = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_planes(slam, planes, capacity, &number));
  return number;
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static double distance_from(const wall_t* wall, const double p[3]) { return dot(wall->normal, p) - wall->distance; }

/* e' C^-1 e of a 3x3 covariance by its adjugate. */
static double mahalanobis(const double e[3], const double C[9]) {
  const double adjugate[9] = {C[4] * C[8] - C[5] * C[7], C[2] * C[7] - C[1] * C[8], C[1] * C[5] - C[2] * C[4],
                              C[5] * C[6] - C[3] * C[8], C[0] * C[8] - C[2] * C[6], C[2] * C[3] - C[0] * C[5],
                              C[3] * C[7] - C[4] * C[6], C[1] * C[6] - C[0] * C[7], C[0] * C[4] - C[1] * C[3]};
  const double det = C[0] * adjugate[0] + C[1] * adjugate[3] + C[2] * adjugate[6];
  TEST_ASSERT_TRUE(det > 0);
  double sum = 0;
  for (int i = 0; i < 3; ++i) sum += e[i] * dot(&adjugate[3 * i], e);
  return sum / det;
}

static const pf_plane_t* plane_like(const pf_plane_t* planes, size_t number, const wall_t* wall) {
  const pf_plane_t* found = NULL;
  for (size_t i = 0; i < number; ++i) {
    if (dot(planes[i].normal_W, wall->normal) < 0.9) continue;
    TEST_ASSERT_NULL_MESSAGE(found, "a wall was found twice");
    found = &planes[i];
  }
  TEST_ASSERT_NOT_NULL_MESSAGE(found, "a wall was not found");
  return found;
}

/* (alpha, beta, delta) as the header defines them, against the truth. */
static void require_true(const pf_plane_t* plane, const wall_t* wall) {
  const double x_W[3] = {plane->R_WP[0], plane->R_WP[3], plane->R_WP[6]};
  const double y_W[3] = {plane->R_WP[1], plane->R_WP[4], plane->R_WP[7]};
  const double e[3] = {dot(wall->normal, x_W), dot(wall->normal, y_W), -distance_from(wall, plane->p_WP)};
  TEST_ASSERT_TRUE(fabs(e[0]) < 0.02 && fabs(e[1]) < 0.02 && fabs(e[2]) < 0.01);
  TEST_ASSERT_TRUE(mahalanobis(e, plane->covariance) < NIS_3_DOF);
  TEST_ASSERT_DOUBLE_WITHIN(1e-6, plane->distance, dot(plane->normal_W, plane->p_WP));
  for (int i = 0; i < 3; ++i) TEST_ASSERT_DOUBLE_WITHIN(1e-6, plane->normal_W[i], plane->R_WP[3 * i + 2]);
}

static void test_planes_should_be_found_where_the_walls_are(void) {
  add_front_and_floor();
  create();
  for (int k = 0; k < 240; ++k) push(k);
  pf_plane_t planes[8];
  const size_t number = all_planes(planes, 8);
  TEST_ASSERT_EQUAL_size_t(2, number);
  const wall_t* walls[2] = {&front, &floor_};
  pf_report_t report;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(slam, &report));
  TEST_ASSERT_EQUAL_INT(2, report.planes);
  int folded = 0, trial = 0;
  for (int w = 0; w < 2; ++w) {
    const pf_plane_t* plane = plane_like(planes, number, walls[w]);
    require_true(plane, walls[w]);
    TEST_ASSERT_GREATER_OR_EQUAL_INT(15, plane->points);
    TEST_ASSERT_GREATER_OR_EQUAL_INT(3, plane->outline_count);
    TEST_ASSERT_TRUE(plane->area > 0.2 && plane->area < (w == 0 ? 2.2 * 1.6 : 1.6 * 0.4) * 1.05);
    TEST_ASSERT_EQUAL_INT(plane->points, plane->members + plane->trial);
    folded += plane->members;
    trial += plane->trial;
  }
  TEST_ASSERT_EQUAL_INT(folded, report.features_folded + report.features_fixed);
  TEST_ASSERT_EQUAL_INT(trial, report.features_trial);

  /* An array that is too small, and none. */
  size_t told = 0;
  const pf_plane_t second = planes[1];
  TEST_ASSERT_EQUAL_INT(PF_NOTE_TRUNCATED, pf_get_planes(slam, planes, 1, &told));
  TEST_ASSERT_EQUAL_size_t(2, told);
  TEST_ASSERT_EQUAL_MEMORY(&second, &planes[1], sizeof second);
  TEST_ASSERT_EQUAL_INT(PF_NOTE_TRUNCATED, pf_get_planes(slam, NULL, 0, &told));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_planes(slam, NULL, 1, &told));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_planes(slam, planes, 1, NULL));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(slam));
  TEST_ASSERT_EQUAL_size_t(0, all_planes(planes, 8));
}

/* Where the true ray through a pixel meets the nearest true wall. */
static const wall_t* true_hit(const double pixel[2], double p_W[3]) {
  const wall_t* walls[2] = {&front, &floor_};
  const wall_t* nearest = NULL;
  double ray[3], best = 1e9;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_camera_unproject(&config.camera, pixel, ray));
  for (int w = 0; w < 2; ++w) {
    const double along = -distance_from(walls[w], camera_W) / dot(walls[w]->normal, ray);
    if (along <= 0 || along >= best) continue;
    best = along;
    nearest = walls[w];
    for (int i = 0; i < 3; ++i) p_W[i] = camera_W[i] + along * ray[i];
  }
  return nearest;
}

static void test_hit_test_should_give_place_and_sigma_of_the_wall_under_a_pixel(void) {
  add_front_and_floor();
  create();
  const double pixel[2] = {300, 200};
  pf_hit_t hit;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_hit_test(slam, pixel, &hit));
  for (int k = 0; k < 10; ++k) push(k);
  TEST_ASSERT_EQUAL_INT(PF_NOTE_NOTHING, pf_hit_test(slam, pixel, &hit));
  for (int k = 10; k < 240; ++k) push(k);
  pf_plane_t planes[8];
  const size_t number = all_planes(planes, 8);
  pf_pose_t pose;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &pose));

  int hits[2] = {0, 0};
  for (int v = 20; v < 480; v += 20) {
    for (int u = 20; u < 640; u += 20) {
      const double at[2] = {u, v};
      double truth[3] = {0, 0, 0};
      const wall_t* wall = true_hit(at, truth);
      const pf_status_t status = pf_hit_test(slam, at, &hit);
      if (status == PF_NOTE_NOTHING) continue; /* outside of the outlines */
      TEST_ASSERT_EQUAL_INT(PF_OK, status);
      TEST_ASSERT_NOT_NULL(wall);
      /* Close to the edge between the walls it may be either. */
      if (fabs(truth[1] - 0.9) + fabs(truth[2] - 2) < 0.1) continue;
      TEST_ASSERT_EQUAL_UINT32(plane_like(planes, number, wall)->id, hit.plane);
      ++hits[wall == &floor_];
      double e[3], from_camera = 0, variance = 0, square = 0;
      for (int i = 0; i < 3; ++i) {
        e[i] = truth[i] - hit.p_W[i];
        square += e[i] * e[i];
        variance += hit.covariance[4 * i];
        from_camera += (hit.p_W[i] - pose.p_WC[i]) * (hit.p_W[i] - pose.p_WC[i]);
      }
      TEST_ASSERT_TRUE(sqrt(square) < 0.02);
      TEST_ASSERT_TRUE(sqrt(variance) < 0.02 && square < 16 * variance);
      TEST_ASSERT_DOUBLE_WITHIN(1e-6, sqrt(from_camera), hit.range);
      double own[9];
      memcpy(own, hit.covariance, sizeof own);
      for (int i = 0; i < 9; i += 4) own[i] += 1e-10;
      TEST_ASSERT_TRUE(mahalanobis(e, own) < NIS_3_DOF);
    }
  }
  TEST_ASSERT_GREATER_THAN_INT(100, hits[0]);
  TEST_ASSERT_GREATER_THAN_INT(10, hits[1]);

  const double beside[2] = {2, 2}, broken[2] = {NAN, 0};
  TEST_ASSERT_EQUAL_INT(PF_NOTE_NOTHING, pf_hit_test(slam, beside, &hit));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NONFINITE, pf_hit_test(slam, broken, &hit));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_hit_test(slam, NULL, &hit));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_hit_test(slam, pixel, NULL));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_hit_test(NULL, pixel, &hit));
}

static void test_find_plane_should_follow_ids_when_planes_are_merged(void) {
  /* Two parts of one wall, too far apart to be found as one plane. */
  add_target();
  for (int i = 0; i < 40; ++i) add_point((i % 2 ? 0.75 : -1.35) + 0.6 * uniform(), -0.8 + 1.6 * uniform(), 2.0);
  config.plane.max_radius = 1.0;
  create();
  uint32_t ids[16];
  int known = 0;
  pf_plane_t planes[8];
  size_t number = 0;
  for (int k = 0; k < 300; ++k) {
    push(k);
    number = all_planes(planes, 8);
    for (size_t i = 0; i < number; ++i) {
      int there = 0;
      uint32_t now = 0;
      for (int j = 0; j < known; ++j) there |= ids[j] == planes[i].id;
      if (!there && known < 16) ids[known++] = planes[i].id;
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_find_plane(slam, planes[i].id, &now));
      TEST_ASSERT_EQUAL_UINT32(planes[i].id, now);
    }
  }
  TEST_ASSERT_GREATER_OR_EQUAL_INT_MESSAGE(1, merges, "no planes were merged");
  TEST_ASSERT_EQUAL_size_t(1, number);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(2, known);
  require_true(&planes[0], &front);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(30, planes[0].points);
  for (int j = 0; j < known; ++j) {
    uint32_t now = 0;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_find_plane(slam, ids[j], &now));
    TEST_ASSERT_EQUAL_UINT32(planes[0].id, now);
  }
  uint32_t now = 9;
  TEST_ASSERT_EQUAL_INT(PF_NOTE_NOTHING, pf_find_plane(slam, 4000000000u, &now));
  TEST_ASSERT_EQUAL_UINT32(0, now);
  TEST_ASSERT_EQUAL_INT(PF_NOTE_NOTHING, pf_find_plane(slam, 0, &now));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_find_plane(slam, ids[0], NULL));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_find_plane(NULL, ids[0], &now));
}

static uint32_t orientation_with(double x, double y, double z, const wall_t* wall) {
  const double gravity[3] = {x, y, z};
  pf_plane_t planes[8];
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_set_gravity(slam, gravity));
  const size_t number = all_planes(planes, 8);
  return plane_like(planes, number, wall)->orientation;
}

static void test_gravity_should_tell_walls_from_floors_and_ceilings(void) {
  add_front_and_floor();
  create();
  for (int k = 0; k < 240; ++k) push(k);
  const double tilt_14 = 0.2443, tilt_16 = 0.2793; /* degrees on either side of the 15 that the header names */
  TEST_ASSERT_EQUAL_UINT32(PF_ORIENTATION_UNKNOWN, orientation_with(0, 0, 0, &front));
  TEST_ASSERT_EQUAL_UINT32(PF_ORIENTATION_VERTICAL, orientation_with(0, 9.8, 0, &front));
  TEST_ASSERT_EQUAL_UINT32(PF_ORIENTATION_HORIZONTAL_UP, orientation_with(0, 9.8, 0, &floor_));
  TEST_ASSERT_EQUAL_UINT32(PF_ORIENTATION_HORIZONTAL_DOWN, orientation_with(0, -1e-3, 0, &floor_));
  TEST_ASSERT_EQUAL_UINT32(PF_ORIENTATION_HORIZONTAL_UP, orientation_with(0, cos(tilt_14), sin(tilt_14), &floor_));
  TEST_ASSERT_EQUAL_UINT32(PF_ORIENTATION_OTHER, orientation_with(0, cos(tilt_16), sin(tilt_16), &floor_));
  TEST_ASSERT_EQUAL_UINT32(PF_ORIENTATION_VERTICAL, orientation_with(0, cos(tilt_14), sin(tilt_14), &front));
  TEST_ASSERT_EQUAL_UINT32(PF_ORIENTATION_OTHER, orientation_with(0, cos(tilt_16), sin(tilt_16), &front));
  TEST_ASSERT_EQUAL_UINT32(PF_ORIENTATION_UNKNOWN, orientation_with(0, 0, 0, &floor_));

  const double broken[3] = {0, INFINITY, 0}, huge[3] = {0, 1e7, 0};
  orientation_with(0, 9.8, 0, &front);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NONFINITE, pf_set_gravity(slam, broken));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_RANGE, pf_set_gravity(slam, huge));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_set_gravity(slam, NULL));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_set_gravity(NULL, huge));
  pf_plane_t planes[8];
  const size_t number = all_planes(planes, 8); /* a refusal has changed nothing */
  TEST_ASSERT_EQUAL_UINT32(PF_ORIENTATION_VERTICAL, plane_like(planes, number, &front)->orientation);
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_planes_should_be_found_where_the_walls_are);
  RUN_TEST(test_hit_test_should_give_place_and_sigma_of_the_wall_under_a_pixel);
  RUN_TEST(test_find_plane_should_follow_ids_when_planes_are_merged);
  RUN_TEST(test_gravity_should_tell_walls_from_floors_and_ceilings);
  return UNITY_END();
}
