/* The window: what it refuses, what its block takes, and that it repeats itself. */
#include <math.h>
#include <planefold/planefold_research.h>
#include <string.h>

#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static pf_config_t config;

static void good_config(void) {
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config));
  config.camera.model = PF_CAMERA_PINHOLE;
  config.camera.width = 640;
  config.camera.height = 480;
  config.camera.fx = config.camera.fy = 500;
  config.camera.cx = 319.5;
  config.camera.cy = 239.5;
  config.backend = PF_BACKEND_WINDOW;
}

static void refuses(const char* field) {
  const char* named = NULL;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_CONFIG, pf_config_check(&config, &named));
  TEST_ASSERT_EQUAL_STRING(field, named);
  good_config();
}

static void use_samples(void) {
  config.motion.model = PF_MOTION_INERTIAL;
  config.capacity.max_imu_samples = 400;
  config.imu.gyro_density = 2e-4;
  config.imu.accel_density = 2e-3;
  config.imu.gyro_walk = 2e-5;
  config.imu.accel_walk = 3e-3;
}

static void test_check_should_name_what_the_window_cannot_do(void) {
  good_config();
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL));
  config.camera.readout_s = 0.03;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL));
  config.plane.fix_sigma = 0.01;
  refuses("plane.fix_sigma");
  config.motion.model = PF_MOTION_CONSTANT_ACCELERATION;
  refuses("motion.model");
  use_samples();
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL));
  config.imu.sigma_readout_s = 0.01;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL));
  config.camera.estimate = PF_CAMERA_CONSIDER;
  refuses("camera.estimate");
  config.capacity.max_patches = 4;
  refuses("capacity.max_patches");
  config.map.features_in_view = 301;
  refuses("map.features_in_view");
}

static void test_block_should_take_two_and_a_half_mebibytes_at_most(void) {
  pf_memory_t need;
  good_config();
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
  TEST_ASSERT_TRUE(need.bytes <= 5u << 19);
}

static void test_block_with_an_inertial_unit_should_take_two_and_three_quarter_mebibytes_at_most(void) {
  pf_memory_t need;
  good_config();
  use_samples();
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
  TEST_ASSERT_TRUE(need.bytes <= 11u << 18);
}

static void test_an_estimated_lens_should_be_taken_with_its_prior(void) {
  static uint8_t block[3u << 20] __attribute__((aligned(64)));
  pf_camera_t lens;
  double covariance[100];
  pf_memory_t exact, need;
  pf_slam_t* slam = NULL;
  good_config();
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &exact));
  config.camera.estimate = PF_CAMERA_ESTIMATE;
  config.camera.sigma_focal = 0.01;
  config.camera.sigma_aspect = 0.001;
  config.camera.sigma_centre_px = 6.4;
  config.camera.sigma_distortion[0] = 0.05;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
  TEST_ASSERT_TRUE(need.bytes > exact.bytes && need.bytes <= sizeof(block));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, sizeof(block), &slam));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_camera(slam, &lens, covariance));
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_RADTAN, lens.model);
  TEST_ASSERT_DOUBLE_WITHIN(0, config.camera.fx, lens.fx);
  TEST_ASSERT_DOUBLE_WITHIN(0, 0, lens.distortion[0]);
  TEST_ASSERT_TRUE(fabs(sqrt(covariance[44]) - 0.05) < 1e-6);
  TEST_ASSERT_TRUE(fabs(sqrt(covariance[0]) / 5 - 1) < 0.01);
}

static void test_calls_of_the_filter_should_be_refused_and_change_nothing(void) {
  static uint8_t block[3u << 20] __attribute__((aligned(64)));
  static uint8_t pixels[640 * 480];
  const pf_image_t image = {pixels, 640, 480, 640, 1000};
  double scratch[8], information[49];
  pf_wall_prior_t prior;
  uint32_t id = 0;
  pf_memory_t need;
  pf_slam_t* slam = NULL;
  good_config();
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
  TEST_ASSERT_TRUE(need.bytes <= sizeof(block) && need.alignment <= 64);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, sizeof(block), &slam));
  memset(&prior, 0, sizeof(prior));
  prior.R_WP[0] = prior.R_WP[4] = prior.R_WP[8] = 1;
  prior.covariance[0] = prior.covariance[4] = prior.covariance[8] = 1e-6;
  prior.outline_count = 3;
  prior.outline_P[0][0] = -1, prior.outline_P[0][1] = -1;
  prior.outline_P[1][0] = 1, prior.outline_P[1][1] = -1;
  prior.outline_P[2][1] = 1;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_add_wall(slam, &prior, &id)); /* before a start in its frame */
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_get_gauge_information(slam, scratch, 8, information));
  /* A picture without a corner: starting, and no crash. */
  memset(pixels, 128, sizeof(pixels));
  TEST_ASSERT_EQUAL_INT(PF_NOTE_STARTING, pf_push_frame(slam, &image));
}

/* A camera that moves to its right before points that something else has found and recognised; frames without any are bridged. */
static void test_pixels_of_the_caller_should_move_the_camera(void) {
  static uint8_t block[3u << 20] __attribute__((aligned(64)));
  enum { POINTS = 120, FRAMES = 60 };
  pf_observation_t seen[POINTS];
  pf_slam_t* slam = NULL;
  pf_pose_t pose;
  pf_report_t report;
  good_config();
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, sizeof(block), &slam));
  for (int k = 0; k < FRAMES; ++k) {
    size_t count = 0;
    uint32_t random = 1;
    for (uint32_t i = 0; i < POINTS; ++i) {
      double x[3];
      for (int a = 0; a < 3; ++a) x[a] = (double)((random = 1664525u * random + 1013904223u) >> 8) / (1 << 24);
      const double z = 2 + 2 * x[2];
      const double u = config.camera.cx + config.camera.fx * (4 * (x[0] - 0.5) - 0.02 * k) / z;
      const double v = config.camera.cy + config.camera.fy * 3 * (x[1] - 0.5) / z;
      if (u < 10 || v < 10 || u > config.camera.width - 11 || v > config.camera.height - 11) continue;
      seen[count].id = i;
      seen[count].pixel[0] = u, seen[count].pixel[1] = v;
      seen[count++].sigma_px = 0.3;
    }
    pf_push_observations(slam, 33000000LL * (k + 1), seen, k == 40 || k == 41 ? 0 : count);
  }
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(slam, &report));
  TEST_ASSERT_EQUAL_INT(PF_STATE_TRACKING, report.state);
  TEST_ASSERT_GREATER_THAN_INT(30, report.inliers);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &pose));
  const double* p = pose.p_WC;
  TEST_ASSERT_TRUE(p[0] > 0.1);
  TEST_ASSERT_DOUBLE_WITHIN(0.02 * p[0], 0, sqrt(p[1] * p[1] + p[2] * p[2]));
  TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1, fabs(pose.q_WC[0]));
  /* It takes one kind of frame. */
  static uint8_t pixels[640 * 480];
  const pf_image_t image = {pixels, 640, 480, 640, 10000000000LL};
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_push_frame(slam, &image));
}

static void test_second_pose_should_be_refused_where_it_says_nothing(void) {
  static uint8_t block[3u << 20] __attribute__((aligned(64)));
  static uint8_t pixels[640 * 480];
  const pf_image_t image = {pixels, 640, 480, 640, 1000};
  pf_slam_t* slam = NULL;
  pf_pose_t pose;
  memset(&pose, 0, sizeof(pose));
  memset(pixels, 128, sizeof(pixels));
  pose.q_WC[0] = 1;
  for (int i = 0; i < 6; ++i) pose.covariance[7 * i] = 1e-6;
  good_config();
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, sizeof(block), &slam));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_RANGE, pf_set_second_pose(slam, 2000, &pose));
  pose.p_WC[0] = 0.01, pose.covariance[21] = 0.02 * 0.02;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_RANGE, pf_set_second_pose(slam, 2000, &pose));
  pose.covariance[21] = 1e-6, pose.p_WC[0] = NAN;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NONFINITE, pf_set_second_pose(slam, 2000, &pose));
  pose.p_WC[0] = 0.3;
  TEST_ASSERT_EQUAL_INT(PF_NOTE_STARTING, pf_push_frame(slam, &image));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_TIME, pf_set_second_pose(slam, 1000, &pose));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_set_second_pose(slam, 2000, &pose));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_set_second_pose(slam, 3000, &pose));
  good_config();
  config.backend = PF_BACKEND_FILTER;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, sizeof(block), &slam));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_set_second_pose(slam, 2000, &pose));
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_check_should_name_what_the_window_cannot_do);
  RUN_TEST(test_block_should_take_two_and_a_half_mebibytes_at_most);
  RUN_TEST(test_block_with_an_inertial_unit_should_take_two_and_three_quarter_mebibytes_at_most);
  RUN_TEST(test_an_estimated_lens_should_be_taken_with_its_prior);
  RUN_TEST(test_calls_of_the_filter_should_be_refused_and_change_nothing);
  RUN_TEST(test_pixels_of_the_caller_should_move_the_camera);
  RUN_TEST(test_second_pose_should_be_refused_where_it_says_nothing);
  return UNITY_END();
}
