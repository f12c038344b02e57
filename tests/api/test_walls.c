/* Walls known beforehand, as a caller gives them: refused where they are no walls, refined by what is seen, doubted where that
 * contradicts them. */
#include <math.h>
#include <planefold/planefold_research.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#define MAX_POINTS 80
#define SIGMA_PX 0.3
#define NIS_3_DOF 16.3 /* chi-squared with 3 degrees of freedom, 99.9 % */

static pf_config_t config;
static unsigned char* raw;
static pf_slam_t* slam;
static double points_W[MAX_POINTS][3];
static int count;
static int merges;
static uint64_t random_state;
static double camera_W[3]; /* where it truly is; it does not rotate */
static int window;         /* with the window, which takes no observations */

static double uniform(void) {
  random_state = random_state * 6364136223846793005u + 1442695040888963407u;
  return ((double)(random_state >> 33) + 0.5) / 2147483648.0;
}

static double normal(void) { return sqrt(-2 * log(uniform())) * cos(6.283185307179586 * uniform()); }

static void on_log(void* user, const char* line) {
  (void)user;
  merges += strstr(line, " merged into ") != NULL;
}

static void open_slam(void) {
  pf_memory_t need;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
  raw = (unsigned char*)malloc(need.bytes + need.alignment);
  TEST_ASSERT_NOT_NULL(raw);
  unsigned char* block = raw + (need.alignment - (uintptr_t)raw % need.alignment) % need.alignment;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, need.bytes, &slam));
}

void setUp(void) {
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config));
  const pf_camera_t camera = {PF_CAMERA_PINHOLE,  640, 480, 400, 400, 319.5, 239.5, {0}, 0, PF_CAMERA_EXACT,
                              PF_TIMESTAMPS_REAL, 0,   0,   0,   {0}};
  config.camera = camera;
  config.measurement.sigma_px = SIGMA_PX;
  config.capacity.max_observations = MAX_POINTS;
  config.plane.roughness = 1e-4; /* these walls are flat */
  config.log = on_log;
  if (window) {
    config.backend = PF_BACKEND_WINDOW;
    config.map.features_in_view = 100;
  }
  random_state = 11;
  merges = 0;
  count = 0;
  raw = NULL;
}

void tearDown(void) { free(raw); }

static void start(void) {
  pf_pose_t pose;
  double velocity[36] = {0};
  memset(&pose, 0, sizeof pose);
  pose.q_WC[0] = 1;
  for (int i = 0; i < 6; ++i) {
    pose.covariance[7 * i] = 1e-8;
    velocity[7 * i] = 0.25;
  }
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_pose(slam, &pose, velocity));
}

static void add_point(double x, double y, double z) {
  TEST_ASSERT_TRUE(count < MAX_POINTS);
  points_W[count][0] = x;
  points_W[count][1] = y;
  points_W[count][2] = z;
  ++count;
}

/* Frame k: the camera sways sideways, up and down and forward, and sees every point that is in its image. */
static pf_status_t push(int k) {
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
  return pf_push_observations(slam, (int64_t)(1e9 * t) + 1, seen, number);
}

static void run(int first, int end) {
  for (int k = first; k < end; ++k) TEST_ASSERT_TRUE(push(k) >= PF_OK);
}

/* A rectangle of 2 x 1.6 m that faces the camera at this distance, rotated about its own vertical axis. */
static pf_wall_prior_t wall_at(double z, double angle) {
  pf_wall_prior_t wall;
  memset(&wall, 0, sizeof wall);
  const double c = cos(angle), s = sin(angle);
  const double R[9] = {c, 0, s, 0, -1, 0, s, 0, -c}; /* x to the right, y up, z to the camera */
  const double corners[4][2] = {{-1, -0.8}, {1, -0.8}, {1, 0.8}, {-1, 0.8}};
  memcpy(wall.R_WP, R, sizeof R);
  wall.p_WP[2] = z;
  wall.covariance[0] = wall.covariance[4] = 0.1 * 0.1;
  wall.covariance[8] = 0.05 * 0.05;
  wall.outline_count = 4;
  memcpy(wall.outline_P, corners, sizeof corners);
  return wall;
}

static pf_plane_t the_wall(uint32_t id) {
  pf_plane_t planes[8], found;
  size_t number = 0;
  memset(&found, 0, sizeof found);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_planes(slam, planes, 8, &number));
  for (size_t i = 0; i < number; ++i)
    if (planes[i].id == id) found = planes[i];
  TEST_ASSERT_EQUAL_UINT32(id, found.id);
  TEST_ASSERT_EQUAL_INT(1, found.is_wall);
  return found;
}

static size_t num_planes(void) {
  size_t number = 0;
  pf_get_planes(slam, NULL, 0, &number);
  return number;
}

static void points_on_front(int number) {
  for (int i = 0; i < number; ++i) add_point(-0.95 + 1.9 * uniform(), -0.75 + 1.5 * uniform(), 2.0);
}

static void test_a_wall_before_a_start_in_its_frame_should_be_refused(void) {
  const pf_wall_prior_t wall = wall_at(2, 0);
  uint32_t id = 77;
  open_slam();
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_add_wall(slam, &wall, &id));
  /* A rectangle without a place is W itself: where the plan is in it, nobody has said. */
  pf_target_t target;
  memset(&target, 0, sizeof target);
  target.kind = PF_TARGET_RECTANGLE;
  target.width = target.height = target.sigma = 0.2;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_target(slam, &target));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_add_wall(slam, &wall, &id));
  target.q_WT[0] = 1;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_target(slam, &target));
  TEST_ASSERT_EQUAL_UINT32(77, id);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_wall(slam, &wall, &id));
  /* And that place cannot be taken back. */
  target.q_WT[0] = 0;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_start_from_target(slam, &target));
  target.q_WT[0] = 2;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_RANGE, pf_start_from_target(slam, &target));
  target.p_WT[1] = NAN;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NONFINITE, pf_start_from_target(slam, &target));

  TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(slam));
  TEST_ASSERT_EQUAL_size_t(0, num_planes());
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_add_wall(slam, &wall, &id));
  if (window) return;
  points_on_front(30);
  run(0, 3); /* W is the first camera now */
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_add_wall(slam, &wall, &id));
}

static void test_without_planes_a_wall_should_be_refused(void) {
  const pf_wall_prior_t wall = wall_at(2, 0);
  uint32_t id;
  config.plane.enabled = 0;
  open_slam();
  start();
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_add_wall(slam, &wall, &id));
}

static void refuses(pf_status_t status, pf_wall_prior_t wall, const char* why) {
  uint32_t id = 77;
  TEST_ASSERT_EQUAL_INT_MESSAGE(status, pf_add_wall(slam, &wall, &id), why);
  TEST_ASSERT_EQUAL_UINT32_MESSAGE(77, id, why);
  TEST_ASSERT_EQUAL_size_t_MESSAGE(0, num_planes(), why);
  pf_report_t report;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(slam, &report));
  TEST_ASSERT_EQUAL_INT_MESSAGE(0, report.planes, why);
}

static void test_what_is_no_wall_should_be_refused_with_nothing_changed(void) {
  const pf_wall_prior_t good = wall_at(2, 0.3);
  pf_wall_prior_t wall;
  uint32_t id;
  open_slam();
  start();
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_add_wall(slam, NULL, &id));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_add_wall(slam, &good, NULL));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_add_wall(NULL, &good, &id));

  double* const numbers[5] = {&wall.R_WP[4], &wall.p_WP[1], &wall.covariance[8], &wall.outline_P[2][1],
                              &wall.roughness};
  for (int i = 0; i < 5; ++i) {
    wall = good;
    *numbers[i] = i % 2 ? NAN : INFINITY;
    refuses(PF_ERROR_NONFINITE, wall, "not finite");
  }
  wall = good;
  for (int i = 0; i < 9; ++i) wall.R_WP[i] *= 1.01;
  refuses(PF_ERROR_RANGE, wall, "a rotation and a scale");
  wall = good;
  for (int i = 0; i < 3; ++i) wall.R_WP[3 * i + 1] = -wall.R_WP[3 * i + 1];
  refuses(PF_ERROR_RANGE, wall, "a reflection");
  wall = good;
  wall.p_WP[0] = 1e7;
  refuses(PF_ERROR_RANGE, wall, "too far");
  for (int i = 0; i < 9; i += 4) {
    wall = good;
    wall.covariance[i] = 0;
    refuses(PF_ERROR_RANGE, wall, "sigma of zero");
    wall.covariance[i] = -1e-6;
    refuses(PF_ERROR_RANGE, wall, "negative variance");
  }
  wall = good; /* each pair is correlated by less than one, and one eigenvalue is negative */
  for (int i = 0; i < 9; ++i) wall.covariance[i] = i % 4 == 0 ? 1 : -0.6;
  refuses(PF_ERROR_RANGE, wall, "negative eigenvalue");
  wall = good;
  wall.covariance[1] = 1e-4;
  refuses(PF_ERROR_RANGE, wall, "not symmetric");

  wall = good;
  wall.outline_count = 2;
  refuses(PF_ERROR_RANGE, wall, "two corners");
  wall.outline_count = PF_OUTLINE_MAX + 1;
  refuses(PF_ERROR_RANGE, wall, "too many corners");
  wall = good;
  memcpy(wall.outline_P[0], good.outline_P[1], sizeof wall.outline_P[0]);
  memcpy(wall.outline_P[1], good.outline_P[0], sizeof wall.outline_P[1]);
  refuses(PF_ERROR_RANGE, wall, "crosses itself");
  wall = good;
  for (int i = 0; i < 4; ++i) memcpy(wall.outline_P[i], good.outline_P[3 - i], sizeof wall.outline_P[0]);
  refuses(PF_ERROR_RANGE, wall, "clockwise");
  wall = good;
  wall.outline_P[1][0] = -0.5;
  wall.outline_P[1][1] = 0.5;
  refuses(PF_ERROR_RANGE, wall, "not convex");
  wall = good;
  wall.outline_count = 5;
  for (int i = 0; i < 5; ++i) { /* a pentagram turns left at every corner, and goes around twice */
    wall.outline_P[i][0] = cos(2 * 1.2566370614359172 * i);
    wall.outline_P[i][1] = sin(2 * 1.2566370614359172 * i);
  }
  refuses(PF_ERROR_RANGE, wall, "pentagram");
  wall = good;
  wall.outline_count = 8;
  for (int i = 0; i < 4; ++i) memcpy(wall.outline_P[4 + i], good.outline_P[i], sizeof wall.outline_P[0]);
  refuses(PF_ERROR_RANGE, wall, "twice around");
  wall = good;
  for (int i = 0; i < 4; ++i) wall.outline_P[i][0] += 1.5;
  refuses(PF_ERROR_RANGE, wall, "the origin is not inside");
  wall = good;
  wall.roughness = 2;
  refuses(PF_ERROR_RANGE, wall, "roughness");
  wall = good;
  wall.two_sided = 2;
  refuses(PF_ERROR_RANGE, wall, "two_sided");
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_wall(slam, &good, &id));
}

static void test_a_wall_should_be_as_it_was_given(void) {
  const pf_wall_prior_t wall = wall_at(2, 0.3);
  uint32_t id = 0;
  open_slam();
  start();
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_wall(slam, &wall, &id));
  const pf_plane_t plane = the_wall(id);
  TEST_ASSERT_EQUAL_INT(0, plane.rejected);
  TEST_ASSERT_EQUAL_INT(0, plane.points);
  for (int i = 0; i < 9; ++i) {
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, wall.R_WP[i], plane.R_WP[i]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, wall.covariance[i], plane.covariance[i]);
  }
  for (int i = 0; i < 3; ++i) TEST_ASSERT_DOUBLE_WITHIN(1e-6, wall.p_WP[i], plane.p_WP[i]);
  TEST_ASSERT_EQUAL_INT(4, plane.outline_count);
  TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2 * 1.6, plane.area);
}

static void test_more_walls_than_planes_should_be_refused(void) {
  uint32_t id = 0, last = 77;
  config.capacity.max_planes = 3;
  open_slam();
  start();
  for (int i = 0; i < 3; ++i) {
    const pf_wall_prior_t wall = wall_at(2 + i, 0);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_wall(slam, &wall, &id));
  }
  const pf_wall_prior_t wall = wall_at(8, 0);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_FULL, pf_add_wall(slam, &wall, &last));
  TEST_ASSERT_EQUAL_UINT32(77, last);
  TEST_ASSERT_EQUAL_size_t(3, num_planes());
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(slam));
  TEST_ASSERT_EQUAL_size_t(0, num_planes());
}

static void test_a_full_state_should_refuse_a_wall_where_everything_is_in_view(void) {
  const pf_wall_prior_t wall = wall_at(2, 0);
  uint32_t id = 0;
  config.capacity.max_state_dim = 60;
  points_on_front(40);
  open_slam();
  start();
  run(0, 20);
  pf_report_t before, after;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(slam, &before));
  TEST_ASSERT_TRUE(before.state_dim + 3 > 60);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_FULL, pf_add_wall(slam, &wall, &id));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(slam, &after));
  TEST_ASSERT_EQUAL_MEMORY(&before, &after, sizeof before);
}

/* e' C^-1 e of a 3x3 covariance by its adjugate. */
static double mahalanobis(const double e[3], const double C[9]) {
  const double adjugate[9] = {C[4] * C[8] - C[5] * C[7], C[2] * C[7] - C[1] * C[8], C[1] * C[5] - C[2] * C[4],
                              C[5] * C[6] - C[3] * C[8], C[0] * C[8] - C[2] * C[6], C[2] * C[3] - C[0] * C[5],
                              C[3] * C[7] - C[4] * C[6], C[1] * C[6] - C[0] * C[7], C[0] * C[4] - C[1] * C[3]};
  const double det = C[0] * adjugate[0] + C[1] * adjugate[3] + C[2] * adjugate[6];
  double sum = 0;
  TEST_ASSERT_TRUE(det > 0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum += e[i] * adjugate[3 * i + j] * e[j];
  return sum / det;
}

/* Against the front wall, z = 2 with its normal to the camera. */
static void require_front(const pf_plane_t* plane, double max_angle, double max_offset) {
  const double e[3] = {-plane->R_WP[6], -plane->R_WP[7], plane->p_WP[2] - 2};
  TEST_ASSERT_TRUE(fabs(e[0]) < max_angle && fabs(e[1]) < max_angle && fabs(e[2]) < max_offset);
  TEST_ASSERT_TRUE(mahalanobis(e, plane->covariance) < NIS_3_DOF);
}

/* Six degrees and 5 cm wrong. A plane in the corner and nothing else says how far away anything is. */
static void test_a_wrong_wall_should_be_refined_and_give_the_world_its_scale(void) {
  const pf_wall_prior_t wall = wall_at(2.05, 0.105);
  uint32_t id = 0;
  points_on_front(40);
  open_slam();
  start();
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_wall(slam, &wall, &id));
  run(0, 300);
  const pf_plane_t plane = the_wall(id);
  TEST_ASSERT_EQUAL_INT(0, plane.rejected);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(25, plane.points);
  TEST_ASSERT_TRUE(plane.area > 2.9);
  require_front(&plane, 0.03, 0.1);
  pf_pose_t pose;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &pose));
  for (int i = 0; i < 3; ++i) TEST_ASSERT_DOUBLE_WITHIN(0.05, camera_W[i], pose.p_WC[i]);
  TEST_ASSERT_EQUAL_size_t(1, num_planes());
}

static void test_a_plane_that_was_found_should_merge_into_a_wall_that_comes_later(void) {
  const pf_wall_prior_t wall = wall_at(2.01, 0.05);
  uint32_t id = 0, found = 0, now = 0;
  config.first_depth.depth = 2; /* before the wall comes nothing else says how far away things are */
  points_on_front(40);
  open_slam();
  start();
  for (int k = 0; k < 200; ++k) {
    run(k, k + 1);
    pf_plane_t plane;
    size_t number = 0;
    if (found == 0 && pf_get_planes(slam, &plane, 1, &number) == PF_OK && number == 1) found = plane.id;
  }
  TEST_ASSERT_TRUE_MESSAGE(found != 0, "no plane was found to begin with");
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_wall(slam, &wall, &id));
  run(200, 400);
  const pf_plane_t plane = the_wall(id);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(25, plane.points);
  TEST_ASSERT_EQUAL_size_t(1, num_planes());
  TEST_ASSERT_GREATER_OR_EQUAL_INT(1, merges);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_find_plane(slam, found, &now));
  TEST_ASSERT_EQUAL_UINT32(id, now);
  require_front(&plane, 0.03, 0.1);
}

static void test_a_wall_that_is_not_there_should_be_doubted_and_a_good_one_not(void) {
  const pf_wall_prior_t good = wall_at(2.01, 0.03);
  pf_wall_prior_t wrong = wall_at(1.4, 0); /* the camera sees through it */
  uint32_t id = 0, not_there = 0;
  for (int i = 0; i < 4; ++i) wrong.outline_P[i][0] *= 0.2; /* before a part of the good one */
  points_on_front(80);
  for (int late = 0; late < 2; ++late) {
    open_slam();
    start();
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_wall(slam, &good, &id));
    if (late) run(0, 100);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_wall(slam, &wrong, &not_there));
    run(100 * late, 100 * late + 60);
    TEST_ASSERT_EQUAL_INT_MESSAGE(1, the_wall(not_there).rejected, "not within two seconds");
    run(100 * late + 60, 300);
    TEST_ASSERT_EQUAL_INT(1, the_wall(not_there).rejected);
    TEST_ASSERT_EQUAL_INT(0, the_wall(not_there).points);
    const pf_plane_t plane = the_wall(id);
    TEST_ASSERT_EQUAL_INT(0, plane.rejected);
    TEST_ASSERT_GREATER_OR_EQUAL_INT(late ? 50 : 10, plane.points);
    if (late) require_front(&plane, 0.03, 0.1);
    free(raw);
    raw = NULL;
  }
}

static void test_a_wall_should_stay_without_points(void) {
  const pf_wall_prior_t wall = wall_at(5, 0);
  uint32_t id = 0;
  points_on_front(40);
  open_slam();
  start();
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_wall(slam, &wall, &id));
  run(0, 200);
  TEST_ASSERT_EQUAL_INT(0, the_wall(id).points);
}

/* Information about the world's place and rotation comes with the wall, and with nothing that is measured on it. */
static void test_a_wall_should_add_information_about_the_gauge_in_its_own_frame_only(void) {
  static double scratch[400 * 408];
  double before[49], now[49];
  uint32_t id = 0;
  const pf_wall_prior_t wall = wall_at(2.02, 0.05);
  config.capacity.max_state_dim = 390;
  config.first_depth.depth = 2;
  points_on_front(40);
  open_slam();
  start();
  run(0, 10);
  const size_t room = sizeof scratch / sizeof *scratch;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_gauge_information(slam, scratch, room, before));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_wall(slam, &wall, &id));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_gauge_information(slam, scratch, room, now));
  /* Along its normal 1 / 0.05^2; it is rotated about the point under W's origin by 1 / 0.1^2. */
  TEST_ASSERT_DOUBLE_WITHIN(1, 400 * cos(0.05) * cos(0.05), now[8 * 2] - before[8 * 2]);
  TEST_ASSERT_TRUE(now[8 * 4] - before[8 * 4] > 99);
  for (int i = 0; i < 7; ++i) TEST_ASSERT_TRUE(now[8 * i] >= before[8 * i] * (1 - 1e-9));
  for (int k = 10; k < 200; ++k) {
    memcpy(before, now, sizeof now);
    run(k, k + 1);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_gauge_information(slam, scratch, room, now));
    for (int i = 0; i < 6; ++i) TEST_ASSERT_TRUE(now[8 * i] <= before[8 * i] * (1 + 1e-9));
  }
  TEST_ASSERT_GREATER_OR_EQUAL_INT(25, the_wall(id).points);
}

static void test_walls_and_a_second_pose_should_refuse_each_other(void) {
  const pf_wall_prior_t wall = wall_at(2, 0);
  uint32_t id = 77;
  pf_pose_t second;
  memset(&second, 0, sizeof second);
  second.q_WC[0] = 1;
  second.p_WC[0] = 0.3;
  for (int i = 0; i < 6; ++i) second.covariance[7 * i] = 1e-4;
  open_slam();
  start();
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_wall(slam, &wall, &id));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_set_second_pose(slam, 1000000000, &second));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(slam));
  start();
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_set_second_pose(slam, 1000000000, &second));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_add_wall(slam, &wall, &id));
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_a_wall_before_a_start_in_its_frame_should_be_refused);
  RUN_TEST(test_without_planes_a_wall_should_be_refused);
  RUN_TEST(test_what_is_no_wall_should_be_refused_with_nothing_changed);
  RUN_TEST(test_a_wall_should_be_as_it_was_given);
  RUN_TEST(test_more_walls_than_planes_should_be_refused);
  RUN_TEST(test_a_full_state_should_refuse_a_wall_where_everything_is_in_view);
  RUN_TEST(test_a_wrong_wall_should_be_refined_and_give_the_world_its_scale);
  RUN_TEST(test_a_plane_that_was_found_should_merge_into_a_wall_that_comes_later);
  RUN_TEST(test_a_wall_that_is_not_there_should_be_doubted_and_a_good_one_not);
  RUN_TEST(test_a_wall_should_stay_without_points);
  RUN_TEST(test_a_wall_should_add_information_about_the_gauge_in_its_own_frame_only);
  window = 1;
  RUN_TEST(test_a_wall_before_a_start_in_its_frame_should_be_refused);
  RUN_TEST(test_without_planes_a_wall_should_be_refused);
  RUN_TEST(test_what_is_no_wall_should_be_refused_with_nothing_changed);
  RUN_TEST(test_a_wall_should_be_as_it_was_given);
  RUN_TEST(test_more_walls_than_planes_should_be_refused);
  RUN_TEST(test_walls_and_a_second_pose_should_refuse_each_other);
  return UNITY_END();
}
