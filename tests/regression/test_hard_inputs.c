/* Inputs that a device meets once in its life, through the observation door: nothing may crash, and every number stays finite. */
#include <math.h>

#include "support/small_context.h"

static int log_lines;
static void count_line(void* user, const char* line) {
  (void)user;
  (void)line;
  ++log_lines;
}

static void again(void) {
  free_block(block);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
  block = new_block(need.bytes, 0xff);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, need.bytes, &slam));
}

static pf_pose_t certain_pose(double velocity_covariance[36]) {
  pf_pose_t pose;
  memset(&pose, 0, sizeof pose);
  memset(velocity_covariance, 0, 36 * sizeof(double));
  pose.q_WC[0] = 1;
  for (int i = 0; i < 6; ++i) pose.covariance[7 * i] = velocity_covariance[7 * i] = 1e-4;
  return pose;
}

static void test_same_id_twice_in_a_call_should_count_once(void) {
  pf_observation_t observations[2 * POINTS];
  pf_report_t report;
  for (int k = 0; k < 3; ++k) {
    observe(k, observations);
    observe(k, observations + POINTS);
    TEST_ASSERT_TRUE(pf_push_observations(slam, STEP_NS * (k + 1), observations, 2 * POINTS) >= PF_OK);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(slam, &report));
    TEST_ASSERT_EQUAL_INT(POINTS, report.features);
    TEST_ASSERT_LESS_OR_EQUAL_INT(POINTS, report.attempts);
    TEST_ASSERT_LESS_OR_EQUAL_INT(2 * POINTS, report.nis_dof);
  }
}

static void test_pixel_without_a_ray_should_not_leave_a_feature_without_an_anchor_when_the_map_is_full(void) {
  config.camera.model = PF_CAMERA_DIVISION;
  config.camera.distortion[0] = 1e-5;
  config.capacity.max_state_dim = 48;
  again();
  pf_observation_t observations[POINTS];
  for (int k = 0; k < 12; ++k) {
    size_t count = observe(k, observations);
    for (size_t i = 0; i < count; ++i) observations[i].id += (uint32_t)(1000 * k); /* all new, all old ones unseen */
    observations[0].pixel[0] = 9e4;                                                /* beyond what the lens shows */
    TEST_ASSERT_TRUE(pf_push_observations(slam, STEP_NS * (k + 1), observations, count) >= PF_OK);
    pf_feature_t features[30];
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_features(slam, features, 30, &count));
    for (size_t i = 0; i < count; ++i)
      for (int a = 0; a < 3; ++a) TEST_ASSERT_TRUE(isfinite(features[i].p_W[a]));
  }
}

static void test_rows_of_the_state_should_not_exceed_what_the_config_says(void) {
  config.capacity.max_state_dim = 49;
  again();
  run(slam, 5);
  pf_report_t report;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(slam, &report));
  TEST_ASSERT_LESS_OR_EQUAL_INT(49, report.state_dim);
}

static void test_timestamps_should_be_welcome_over_their_whole_range(void) {
  pf_observation_t observations[POINTS];
  pf_pose_t pose;
  const int64_t times[] = {INT64_MIN, INT64_MIN + STEP_NS, -1, INT64_MAX - 1, INT64_MAX};
  for (int k = 0; k < 5; ++k) {
    const size_t count = observe(k, observations);
    TEST_ASSERT_TRUE(pf_push_observations(slam, times[k], observations, count) >= PF_OK);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &pose));
    for (int i = 0; i < 3; ++i) TEST_ASSERT_TRUE(isfinite(pose.p_WC[i]));
    if (k < 3) TEST_ASSERT_EQUAL_INT(PF_ERROR_RANGE, pf_predict_pose(slam, INT64_MAX, &pose));
  }
}

static void test_filter_should_start_over_and_say_so_when_the_state_leaves_all_bounds(void) {
  config.log = count_line;
  again();
  run(slam, 3);
  log_lines = 0;
  pf_pose_t pose;
  pf_status_t status = PF_OK;
  const double push_v[3] = {1e6, 0, 0}, turn[3] = {0, 0, 0};
  int64_t t_ns = STEP_NS * 4;
  for (int k = 0; k < 2000 && log_lines == 0; ++k, t_ns += INT64_C(2000000000)) {
    for (int i = 0; i < 5; ++i) TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_control(slam, push_v, turn));
    status = pf_push_observations(slam, t_ns, NULL, 0);
    if (pf_get_pose(slam, &pose) == PF_OK) TEST_ASSERT_TRUE(isfinite(pose.p_WC[0]));
    if (log_lines == 1 && status == PF_NOTE_LOST) log_lines = 0; /* being lost is said too */
  }
  TEST_ASSERT_EQUAL_INT(1, log_lines);
  TEST_ASSERT_EQUAL_INT(PF_NOTE_STARTING, status);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_get_pose(slam, &pose));
  pf_observation_t observations[POINTS];
  const size_t count = observe(0, observations);
  TEST_ASSERT_TRUE(pf_push_observations(slam, t_ns + STEP_NS, observations, count) >= PF_OK);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &pose));
}

static void test_starts_that_no_camera_can_be_in_should_be_refused(void) {
  double velocity[36];
  const pf_pose_t good = certain_pose(velocity);
  pf_pose_t bad = good;
  bad.covariance[0] = 1e200;
  REFUSES(PF_ERROR_RANGE, pf_start_from_pose(slam, &bad, velocity));
  bad = good;
  bad.w_C[0] = 1e200;
  REFUSES(PF_ERROR_RANGE, pf_start_from_pose(slam, &bad, velocity));
  bad = good; /* every pair is a covariance, the three together are not */
  bad.covariance[1] = bad.covariance[6] = bad.covariance[2] = bad.covariance[12] = 0.9e-4;
  bad.covariance[8] = bad.covariance[13] = -0.9e-4;
  REFUSES(PF_ERROR_RANGE, pf_start_from_pose(slam, &bad, velocity));
  const double huge[3] = {1e300, 0, 0}, none[3] = {0, 0, 0};
  REFUSES(PF_ERROR_RANGE, pf_push_control(slam, huge, none));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_pose(slam, &good, velocity));
}

static void test_target_should_be_refused_when_it_does_not_fit_or_the_door_cannot_show_it(void) {
  pf_target_t target;
  double velocity[36];
  memset(&target, 0, sizeof target);
  target.kind = PF_TARGET_POINTS;
  target.sigma = 0.001;
  target.first_pose = certain_pose(velocity);
  target.count = PF_TARGET_MAX_POINTS;
  for (int i = 0; i < target.count; ++i) target.points_W[i][2] = 1; /* all in one place */
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_target(slam, &target));
  run(slam, 5);
  config.capacity.max_state_dim = 32;
  again();
  REFUSES(PF_ERROR_RANGE, pf_start_from_target(slam, &target));
  target.kind = PF_TARGET_RECTANGLE;
  target.width = target.height = 0.2;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_target(slam, &target));
  REFUSES(PF_ERROR_STATE, push(slam, 0));
}

static int refused_calls;
static void reset_from_inside(void* user, const char* line) {
  (void)user;
  (void)line;
  const double none[3] = {0, 0, 0};
  refused_calls += pf_reset(slam) == PF_ERROR_STATE && pf_set_gravity(slam, none) == PF_ERROR_STATE;
}

static void test_a_reset_from_inside_the_log_should_be_refused(void) {
  config.log = reset_from_inside;
  again();
  run(slam, 3);
  pf_pose_t pose;
  pf_state_t state;
  for (int k = 3; k < 60; ++k) {
    TEST_ASSERT_TRUE(pf_push_observations(slam, STEP_NS * (k + 1), NULL, 0) >=
                     PF_OK); /* until it says that it is lost */
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &pose));
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_state(slam, &state));
    TEST_ASSERT_NOT_EQUAL(PF_STATE_STARTING, state);
  }
  TEST_ASSERT_EQUAL_INT(PF_STATE_LOST, state);
  TEST_ASSERT_GREATER_THAN_INT(0, refused_calls);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(slam));
}

/* A reset says that rows have no time of their own: a caller that answers by a reset must not be asked again. */
static void test_a_reset_from_inside_the_log_of_a_reset_should_be_refused(void) {
  config.camera.readout_s = 0.01;
  config.camera.timestamps = PF_TIMESTAMPS_NOMINAL;
  config.log = reset_from_inside;
  refused_calls = 0;
  again();
  TEST_ASSERT_EQUAL_INT(1, refused_calls);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(slam));
  TEST_ASSERT_EQUAL_INT(2, refused_calls);
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_same_id_twice_in_a_call_should_count_once);
  RUN_TEST(test_pixel_without_a_ray_should_not_leave_a_feature_without_an_anchor_when_the_map_is_full);
  RUN_TEST(test_rows_of_the_state_should_not_exceed_what_the_config_says);
  RUN_TEST(test_timestamps_should_be_welcome_over_their_whole_range);
  RUN_TEST(test_filter_should_start_over_and_say_so_when_the_state_leaves_all_bounds);
  RUN_TEST(test_starts_that_no_camera_can_be_in_should_be_refused);
  RUN_TEST(test_target_should_be_refused_when_it_does_not_fit_or_the_door_cannot_show_it);
  RUN_TEST(test_a_reset_from_inside_the_log_should_be_refused);
  RUN_TEST(test_a_reset_from_inside_the_log_of_a_reset_should_be_refused);
  return UNITY_END();
}
