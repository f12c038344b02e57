/* The door as a caller sees it: what is refused, with which status, and that a refusal changes nothing. */
#include <math.h>
#include <planefold/planefold_research.h>
#include <string.h>

#include "small_context.h"

static void test_every_call_should_refuse_null(void) {
  const double three[3] = {0, 0, 1}, two[2] = {80, 60};
  double out[49], scratch[8];
  size_t count;
  pf_pose_t pose;
  pf_state_t state;
  pf_report_t report;
  pf_imu_report_t imu;
  pf_inertial_t inertial;
  pf_imu_sample_t sample;
  pf_image_t image = {pixels, WIDTH, HEIGHT, WIDTH, 1};
  pf_target_t target;
  pf_slam_t* none;
  memset(&target, 0, sizeof target);
  memset(&pose, 0, sizeof pose);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_config_default(NULL));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_config_check(NULL, NULL));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_memory_query(NULL, &need));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_memory_query(&config, NULL));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_camera_project(NULL, three, out));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_camera_project(&config.camera, NULL, out));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_camera_project(&config.camera, three, NULL));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_camera_unproject(NULL, two, out));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_camera_unproject(&config.camera, NULL, out));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_camera_unproject(&config.camera, two, NULL));
  none = slam;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_create(NULL, block, need.bytes, &none));
  TEST_ASSERT_NULL(none);
  none = slam;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_create(&config, NULL, need.bytes, &none));
  TEST_ASSERT_NULL(none);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_create(&config, block, need.bytes, NULL));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_reset(NULL));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_start_from_target(NULL, &target));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_start_from_pose(NULL, &pose, out));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_withdraw_target(NULL));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_set_second_pose(NULL, 1, &pose));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_push_frame(NULL, &image));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_push_observations(NULL, 1, NULL, 0));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_push_control(NULL, three, three));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_push_imu(NULL, NULL, 0));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_imu_report(NULL, &imu));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_imu_samples(NULL, &sample, 1, &count));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_inertial(NULL, &inertial));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_state(NULL, &state));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_pose(NULL, &pose));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_predict_pose(NULL, 1, &pose));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_project_point(NULL, three, out, NULL));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_features(NULL, NULL, 0, &count));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_matches(NULL, NULL, 0, &count));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_patches(NULL, NULL, 0, &count));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_report(NULL, &report));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_gauge_information(NULL, scratch, 8, out));
  REFUSES(PF_ERROR_NULL, pf_start_from_target(slam, NULL));
  REFUSES(PF_ERROR_NULL, pf_start_from_pose(slam, NULL, out));
  run(slam, 3);
  image.pixels = NULL;
  REFUSES(PF_ERROR_NULL, pf_push_frame(slam, NULL));
  REFUSES(PF_ERROR_NULL, pf_push_frame(slam, &image));
  REFUSES(PF_ERROR_NULL, pf_push_observations(slam, STEP_NS * 90, NULL, 3));
  REFUSES(PF_ERROR_NULL, pf_push_control(slam, NULL, three));
  REFUSES(PF_ERROR_NULL, pf_push_control(slam, three, NULL));
  REFUSES(PF_ERROR_NULL, pf_push_imu(slam, NULL, 1));
  REFUSES(PF_ERROR_NULL, pf_get_imu_report(slam, NULL));
  REFUSES(PF_ERROR_NULL, pf_get_inertial(slam, NULL));
  REFUSES(PF_ERROR_NULL, pf_get_imu_samples(slam, NULL, 1, &count));
  REFUSES(PF_ERROR_NULL, pf_get_imu_samples(slam, &sample, 1, NULL));
  REFUSES(PF_ERROR_NULL, pf_get_state(slam, NULL));
  REFUSES(PF_ERROR_NULL, pf_get_pose(slam, NULL));
  REFUSES(PF_ERROR_NULL, pf_predict_pose(slam, STEP_NS * 90, NULL));
  REFUSES(PF_ERROR_NULL, pf_project_point(slam, NULL, out, NULL));
  REFUSES(PF_ERROR_NULL, pf_project_point(slam, three, NULL, NULL));
  REFUSES(PF_ERROR_NULL, pf_get_features(slam, NULL, 0, NULL));
  REFUSES(PF_ERROR_NULL, pf_get_features(slam, NULL, 3, &count));
  REFUSES(PF_ERROR_NULL, pf_get_matches(slam, NULL, 0, NULL));
  REFUSES(PF_ERROR_NULL, pf_get_patches(slam, NULL, 0, NULL));
  REFUSES(PF_ERROR_NULL, pf_get_patches(slam, NULL, 1, &count));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_patches(slam, NULL, 0, &count)); /* the config has no room for any */
  TEST_ASSERT_EQUAL_size_t(0, count);
  REFUSES(PF_ERROR_NULL, pf_get_report(slam, NULL));
  REFUSES(PF_ERROR_NULL, pf_get_gauge_information(slam, NULL, 8, out));
  REFUSES(PF_ERROR_NULL, pf_get_gauge_information(slam, scratch, 8, NULL));
  REFUSES(PF_ERROR_MEMORY, pf_get_gauge_information(slam, scratch, 8, out));
}

static void test_non_finite_numbers_should_be_refused_and_change_nothing(void) {
  const double bad[3] = {NAN, INFINITY, -INFINITY};
  run(slam, 5);
  for (int b = 0; b < 3; ++b) {
    const double three[3] = {0, bad[b], 1}, zero[3] = {0, 0, 0};
    double out[3];
    pf_observation_t observations[POINTS];
    REFUSES(PF_ERROR_NONFINITE, pf_push_control(slam, three, zero));
    REFUSES(PF_ERROR_NONFINITE, pf_push_control(slam, zero, three));
    REFUSES(PF_ERROR_NONFINITE, pf_project_point(slam, three, out, NULL));
    TEST_ASSERT_EQUAL_INT(PF_ERROR_NONFINITE, pf_camera_project(&config.camera, three, out));
    TEST_ASSERT_EQUAL_INT(PF_ERROR_NONFINITE, pf_camera_unproject(&config.camera, three, out));
    observe(5, observations);
    observations[POINTS - 1].pixel[1] = bad[b];
    REFUSES(PF_ERROR_NONFINITE, pf_push_observations(slam, STEP_NS * 90, observations, POINTS));
    observe(5, observations);
    observations[0].sigma_px = bad[b];
    REFUSES(PF_ERROR_NONFINITE, pf_push_observations(slam, STEP_NS * 90, observations, POINTS));
  }
}

static void test_numbers_outside_of_their_domain_should_be_refused_and_change_nothing(void) {
  pf_observation_t observations[POINTS];
  const double behind[3] = {0, 0, -5};
  double out[2];
  pf_pose_t pose;
  run(slam, 5);
  observe(5, observations);
  observations[3].sigma_px = -1;
  REFUSES(PF_ERROR_RANGE, pf_push_observations(slam, STEP_NS * 90, observations, POINTS));
  observations[3].sigma_px = 1e-6;
  REFUSES(PF_ERROR_RANGE, pf_push_observations(slam, STEP_NS * 90, observations, POINTS));
  observe(5, observations);
  observations[3].pixel[0] = 1e9;
  REFUSES(PF_ERROR_RANGE, pf_push_observations(slam, STEP_NS * 90, observations, POINTS));
  REFUSES(PF_ERROR_RANGE, pf_project_point(slam, behind, out, NULL));
  REFUSES(PF_ERROR_RANGE, pf_predict_pose(slam, STEP_NS * 90000, &pose));
}

static void test_time_should_be_refused_when_it_stands_still_or_runs_back(void) {
  pf_observation_t observations[POINTS];
  pf_pose_t pose;
  run(slam, 5);
  observe(5, observations);
  REFUSES(PF_ERROR_TIME, pf_push_observations(slam, STEP_NS * 5, observations, POINTS));
  REFUSES(PF_ERROR_TIME, pf_push_observations(slam, STEP_NS, observations, POINTS));
  REFUSES(PF_ERROR_TIME, pf_push_observations(slam, INT64_MIN, observations, POINTS));
  REFUSES(PF_ERROR_TIME, pf_predict_pose(slam, STEP_NS * 5 - 1, &pose));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_predict_pose(slam, STEP_NS * 5, &pose));
  TEST_ASSERT_TRUE(push(slam, 5) >= PF_OK);
}

static void test_frames_should_be_refused_when_their_size_or_time_is_wrong(void) {
  pf_image_t image = {pixels, WIDTH, HEIGHT, WIDTH, STEP_NS};
  TEST_ASSERT_TRUE(pf_push_frame(slam, &image) >= PF_OK);
  REFUSES(PF_ERROR_TIME, pf_push_frame(slam, &image));
  image.t_ns = STEP_NS * 2;
  image.width = WIDTH - 1;
  REFUSES(PF_ERROR_SIZE, pf_push_frame(slam, &image));
  image.width = WIDTH;
  image.height = HEIGHT + 1;
  REFUSES(PF_ERROR_SIZE, pf_push_frame(slam, &image));
  image.height = HEIGHT;
  image.stride = WIDTH - 1;
  REFUSES(PF_ERROR_SIZE, pf_push_frame(slam, &image));
  image.stride = -WIDTH;
  REFUSES(PF_ERROR_SIZE, pf_push_frame(slam, &image));
  image.stride = WIDTH;
  TEST_ASSERT_TRUE(pf_push_frame(slam, &image) >= PF_OK);
}

static void test_a_context_should_take_frames_or_observations_but_not_both(void) {
  pf_image_t image = {pixels, WIDTH, HEIGHT, WIDTH, STEP_NS * 90};
  run(slam, 2);
  REFUSES(PF_ERROR_STATE, pf_push_frame(slam, &image));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(slam));
  TEST_ASSERT_TRUE(pf_push_frame(slam, &image) >= PF_OK);
  REFUSES(PF_ERROR_STATE, pf_push_observations(slam, STEP_NS * 91, NULL, 0));
}

static void test_a_start_should_be_refused_after_the_first_frame_and_a_pose_before_it(void) {
  pf_pose_t pose;
  pf_target_t target;
  double velocity[36] = {0}, out[2];
  const double ahead[3] = {0, 0, 2};
  memset(&target, 0, sizeof target);
  target.kind = PF_TARGET_RECTANGLE;
  target.width = 0.2;
  target.height = 0.3;
  target.sigma = 0.001;
  REFUSES(PF_ERROR_STATE, pf_get_pose(slam, &pose));
  REFUSES(PF_ERROR_STATE, pf_predict_pose(slam, 1, &pose));
  REFUSES(PF_ERROR_STATE, pf_project_point(slam, ahead, out, NULL));
  run(slam, 1);
  memset(&pose, 0, sizeof pose);
  pose.q_WC[0] = 1;
  for (int i = 0; i < 6; ++i) pose.covariance[7 * i] = velocity[7 * i] = 0.01;
  REFUSES(PF_ERROR_STATE, pf_start_from_target(slam, &target));
  REFUSES(PF_ERROR_STATE, pf_start_from_pose(slam, &pose, velocity));
}

static void test_a_start_should_be_refused_when_its_numbers_make_no_sense(void) {
  pf_pose_t pose, bad;
  pf_target_t target, wrong;
  double velocity[36] = {0};
  memset(&pose, 0, sizeof pose);
  memset(&target, 0, sizeof target);
  pose.q_WC[0] = 1;
  for (int i = 0; i < 6; ++i) pose.covariance[7 * i] = velocity[7 * i] = 0.01;
  target.kind = PF_TARGET_RECTANGLE;
  target.width = 0.2;
  target.height = 0.3;
  target.sigma = 0.001;

  bad = pose;
  bad.q_WC[0] = 0.5;
  REFUSES(PF_ERROR_RANGE, pf_start_from_pose(slam, &bad, velocity));
  bad = pose;
  bad.p_WC[1] = NAN;
  REFUSES(PF_ERROR_NONFINITE, pf_start_from_pose(slam, &bad, velocity));
  bad = pose;
  bad.covariance[1] = 0.5;
  REFUSES(PF_ERROR_RANGE, pf_start_from_pose(slam, &bad, velocity));
  bad = pose;
  bad.covariance[0] = -1;
  REFUSES(PF_ERROR_RANGE, pf_start_from_pose(slam, &bad, velocity));
  /* Two rows that are known to be the same cannot correlate with a third one in opposite ways. */
  bad = pose;
  bad.covariance[6 * 1 + 0] = bad.covariance[6 * 0 + 1] = 0.01;
  bad.covariance[6 * 2 + 0] = bad.covariance[6 * 0 + 2] = 0.005;
  bad.covariance[6 * 2 + 1] = bad.covariance[6 * 1 + 2] = -0.005;
  REFUSES(PF_ERROR_RANGE, pf_start_from_pose(slam, &bad, velocity));
  bad = pose;
  bad.covariance[0] = 0;
  bad.covariance[1] = bad.covariance[6] = 0.005;
  REFUSES(PF_ERROR_RANGE, pf_start_from_pose(slam, &bad, velocity));
  bad = pose;
  bad.covariance[7] = 1e-20; /* information that no float can hold */
  REFUSES(PF_ERROR_RANGE, pf_start_from_pose(slam, &bad, velocity));
  REFUSES(PF_ERROR_NULL, pf_start_from_pose(slam, &pose, NULL));
  wrong = target;
  wrong.kind = 9;
  REFUSES(PF_ERROR_RANGE, pf_start_from_target(slam, &wrong));
  wrong = target;
  wrong.width = 0;
  REFUSES(PF_ERROR_RANGE, pf_start_from_target(slam, &wrong));
  wrong = target;
  wrong.height = NAN;
  REFUSES(PF_ERROR_NONFINITE, pf_start_from_target(slam, &wrong));
  wrong = target;
  wrong.sigma = -1;
  REFUSES(PF_ERROR_RANGE, pf_start_from_target(slam, &wrong));
  wrong.sigma = 1e-200;
  REFUSES(PF_ERROR_RANGE, pf_start_from_target(slam, &wrong));
  wrong = target;
  wrong.kind = PF_TARGET_POINTS;
  wrong.count = 3;
  REFUSES(PF_ERROR_RANGE, pf_start_from_target(slam, &wrong));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_target(slam, &target));
}

static void test_a_rectangle_and_a_known_pose_should_not_both_be_the_start(void) {
  pf_pose_t pose;
  pf_target_t target;
  double velocity[36] = {0};
  memset(&pose, 0, sizeof pose);
  memset(&target, 0, sizeof target);
  pose.q_WC[0] = 1;
  for (int i = 0; i < 6; ++i) pose.covariance[7 * i] = velocity[7 * i] = 0.01;
  target.kind = PF_TARGET_RECTANGLE;
  target.width = 0.2;
  target.height = 0.3;
  target.sigma = 0.001;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_target(slam, &target));
  REFUSES(PF_ERROR_STATE, pf_start_from_pose(slam, &pose, velocity));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(slam));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_pose(slam, &pose, velocity));
  REFUSES(PF_ERROR_STATE, pf_start_from_target(slam, &target));
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_every_call_should_refuse_null);
  RUN_TEST(test_non_finite_numbers_should_be_refused_and_change_nothing);
  RUN_TEST(test_numbers_outside_of_their_domain_should_be_refused_and_change_nothing);
  RUN_TEST(test_time_should_be_refused_when_it_stands_still_or_runs_back);
  RUN_TEST(test_frames_should_be_refused_when_their_size_or_time_is_wrong);
  RUN_TEST(test_a_context_should_take_frames_or_observations_but_not_both);
  RUN_TEST(test_a_start_should_be_refused_after_the_first_frame_and_a_pose_before_it);
  RUN_TEST(test_a_start_should_be_refused_when_its_numbers_make_no_sense);
  RUN_TEST(test_a_rectangle_and_a_known_pose_should_not_both_be_the_start);
  return UNITY_END();
}
