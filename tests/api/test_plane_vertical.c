/* Planes that are told to be vertical, and classes of planes by probability: a camera with an inertial unit that rests, then sways before a
 * wall and a floor. */
#include <math.h>
#include <planefold/planefold.h>
#include <stdlib.h>
#include <string.h>

#include "support/inertial_unit.h"
#include "unity.h"

#define MAX_POINTS 60
#define TARGET_POINTS 9
#define SIGMA_PX 0.3
#define REST_S 1.5
#define GRAVITY 9.81

static pf_config_t config;
static unsigned char* raw;
static pf_slam_t* slam;
static double points_W[MAX_POINTS][3];
static int count, sample;
static uint64_t random_state;

static double uniform(void) {
  random_state = random_state * 6364136223846793005u + 1442695040888963407u;
  return ((double)(random_state >> 33) + 0.5) / 2147483648.0;
}

static double normal(void) { return sqrt(-2 * log(uniform())) * cos(6.283185307179586 * uniform()); }

static void add_point(double x, double y, double z) {
  const double p[3] = {x, y, z};
  memcpy(points_W[count++], p, sizeof p);
}

void setUp(void) {
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config));
  const pf_camera_t camera = {PF_CAMERA_PINHOLE,  640, 480, 400, 400, 319.5, 239.5, {0}, 0, PF_CAMERA_EXACT,
                              PF_TIMESTAMPS_REAL, 0,   0,   0,   {0}};
  config.camera = camera;
  config.measurement.sigma_px = SIGMA_PX;
  config.capacity.max_observations = MAX_POINTS;
  config.first_depth.depth = 2;
  config.plane.roughness = 1e-4;
  use_inertial_unit(&config, 400);
  random_state = 7;
  count = sample = 0;
  raw = NULL;
  for (int i = 0; i < TARGET_POINTS; ++i) add_point(-0.3 + 0.3 * (i % 3), -0.3 + 0.3 * (i / 3), 1.5 + 0.07 * (i % 4));
  for (int i = 0; i < 26; ++i) add_point(-1.1 + 2.2 * uniform(), -0.9 + 1.6 * uniform(), 2.0);
  for (int i = 0; i < 24; ++i) add_point(-0.8 + 1.6 * uniform(), 0.9, 1.75 - 0.4 * uniform());
}

void tearDown(void) { free(raw); }

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

/* Along an axis, and its second derivative. The camera does not rotate. */
static const double sway[3] = {0.4, 0.2, 0.15}, rate[3] = {1, 1.7, 1.3};
static double place(int axis, double t) { return t < REST_S ? 0 : sway[axis] * (1 - cos(rate[axis] * (t - REST_S))); }
static double acceleration(int axis, double t) {
  return t < REST_S ? 0 : sway[axis] * rate[axis] * rate[axis] * cos(rate[axis] * (t - REST_S));
}

static void push(int k) {
  const double t = k / 30.0;
  for (; sample * 0.005 <= t; ++sample) {
    pf_imu_sample_t s;
    const double at = sample * 0.005;
    s.t_ns = (int64_t)(1e9 * at) + 1;
    for (int i = 0; i < 3; ++i) {
      s.gyro[i] = 2e-4 / sqrt(0.005) * normal();
      s.accel[i] = acceleration(i, at) - (i == 1 ? GRAVITY : 0) + 2e-3 / sqrt(0.005) * normal();
    }
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_imu(slam, &s, 1));
  }
  pf_observation_t seen[MAX_POINTS];
  size_t number = 0;
  for (int i = 0; i < count; ++i) {
    double p_C[3];
    for (int a = 0; a < 3; ++a) p_C[a] = points_W[i][a] - place(a, t);
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

/* The plane whose normal is most like this one. */
static pf_plane_t plane_along(int axis) {
  pf_plane_t planes[16], best;
  size_t number = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_planes(slam, planes, 16, &number));
  memset(&best, 0, sizeof best);
  for (size_t i = 0; i < number; ++i)
    if (best.id == 0 || fabs(planes[i].normal_W[axis]) > fabs(best.normal_W[axis])) best = planes[i];
  TEST_ASSERT_TRUE_MESSAGE(fabs(best.normal_W[axis]) > 0.95, "no such plane");
  return best;
}

/* Variance of gravity's rotation about an axis of W. */
static double tilt_variance(int axis) {
  pf_inertial_t unit;
  double sum = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_inertial(slam, &unit));
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      sum += unit.gravity_axes_W[i][axis] * unit.covariance[8 * i + j] * unit.gravity_axes_W[j][axis];
  return sum;
}

static void test_planes_should_have_no_class_before_gravity_is_known_and_the_right_one_after(void) {
  create();
  int seen = 0;
  for (int k = 0; k < 240; ++k) {
    push(k);
    pf_inertial_t unit;
    pf_plane_t planes[16];
    size_t number = 0;
    const int known = pf_get_inertial(slam, &unit) == PF_OK && unit.metric != 0;
    pf_get_planes(slam, planes, 16, &number);
    for (size_t i = 0; i < number; ++i) {
      if (!known) TEST_ASSERT_EQUAL_INT32(PF_ORIENTATION_UNKNOWN, planes[i].orientation);
      if (planes[i].orientation == PF_ORIENTATION_UNKNOWN) continue;
      const int is_floor = fabs(planes[i].normal_W[1]) > 0.7;
      TEST_ASSERT_EQUAL_INT32(is_floor ? PF_ORIENTATION_HORIZONTAL_UP : PF_ORIENTATION_VERTICAL, planes[i].orientation);
      ++seen;
    }
  }
  TEST_ASSERT_TRUE(seen > 50);
  TEST_ASSERT_EQUAL_INT32(PF_ORIENTATION_VERTICAL, plane_along(2).orientation);
  TEST_ASSERT_EQUAL_INT32(PF_ORIENTATION_HORIZONTAL_UP, plane_along(1).orientation);
  const double odd[3] = {0, 1,
                         0.2679}; /* 15 degrees off: on the edge, and given by the caller it goes before the estimate */
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_set_gravity(slam, odd));
  TEST_ASSERT_EQUAL_INT32(PF_ORIENTATION_UNKNOWN, plane_along(2).orientation);
}

static void test_a_plane_should_be_vertical_once_and_be_forgotten(void) {
  create();
  for (int k = 0; k < 150; ++k) push(k);
  const pf_plane_t wall = plane_along(2), ground = plane_along(1);
  const double before = tilt_variance(0), other = tilt_variance(2);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_RANGE, pf_set_plane_vertical(slam, ground.id, 0.001));
  TEST_ASSERT_EQUAL_DOUBLE(before, tilt_variance(0));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_set_plane_vertical(slam, wall.id, 0.0005));
  const double once = tilt_variance(0);
  TEST_ASSERT_TRUE(once < 0.8 * before);
  TEST_ASSERT_TRUE(fabs(tilt_variance(2) / other - 1) < 0.1); /* it says nothing of a rotation about its own normal */
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_set_plane_vertical(slam, wall.id, 0.0005));
  TEST_ASSERT_EQUAL_DOUBLE(once, tilt_variance(0));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_set_plane_vertical(slam, ground.id, 0)); /* nobody said it */
  TEST_ASSERT_EQUAL_DOUBLE(once, tilt_variance(0));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_set_plane_vertical(slam, wall.id, 0));
  TEST_ASSERT_TRUE(tilt_variance(0) > 0.9 * before);
  push(150);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_set_plane_vertical(slam, wall.id, 0.001));
}

static void test_bad_input_should_be_refused(void) {
  create();
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_set_plane_vertical(slam, 1, 0.01));
  for (int k = 0; k < 150; ++k) push(k);
  const pf_plane_t wall = plane_along(2);
  TEST_ASSERT_EQUAL_INT(PF_NOTE_NOTHING, pf_set_plane_vertical(slam, 4000000000u, 0.01));
  TEST_ASSERT_EQUAL_INT(PF_NOTE_NOTHING, pf_set_plane_vertical(slam, 0, 0.01));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NONFINITE, pf_set_plane_vertical(slam, wall.id, NAN));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NONFINITE, pf_set_plane_vertical(slam, wall.id, INFINITY));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_RANGE, pf_set_plane_vertical(slam, wall.id, -0.01));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_RANGE, pf_set_plane_vertical(slam, wall.id, 0.6));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_RANGE, pf_set_plane_vertical(slam, wall.id, 1e-9));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_set_plane_vertical(NULL, wall.id, 0.01));
}

static void test_it_should_be_refused_where_gravity_is_not_estimated(void) {
  config.motion.model = PF_MOTION_CONSTANT_VELOCITY;
  create();
  for (int k = 0; k < 150; ++k) push(k);
  const double down[3] = {0, 1, 0};
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_set_gravity(slam, down));
  const pf_plane_t wall = plane_along(2);
  TEST_ASSERT_EQUAL_INT32(PF_ORIENTATION_VERTICAL, wall.orientation);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_set_plane_vertical(slam, wall.id, 0.01));
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_planes_should_have_no_class_before_gravity_is_known_and_the_right_one_after);
  RUN_TEST(test_a_plane_should_be_vertical_once_and_be_forgotten);
  RUN_TEST(test_bad_input_should_be_refused);
  RUN_TEST(test_it_should_be_refused_where_gravity_is_not_estimated);
  return UNITY_END();
}
