/* A mark and the motion since then: when it can be set, what it says, and when it is gone. */
#include <math.h>
#include <planefold/planefold.h>
#include <string.h>

#include "small_context.h"

static pf_motion_t motion;

static void require_nothing(const pf_slam_t* of) {
  pf_motion_t before;
  memset(&motion, 7, sizeof motion);
  before = motion;
  TEST_ASSERT_EQUAL_INT(PF_NOTE_NOTHING, pf_get_motion_since_mark(of, &motion));
  TEST_ASSERT_EQUAL_MEMORY(&before, &motion, sizeof motion);
}

static double rounding(void) { return config.scalar == PF_SCALAR_FLOAT ? 1e-6 : 1e-12; }

static int32_t state_dim(const pf_slam_t* of) {
  pf_report_t report;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(of, &report));
  return report.state_dim;
}

static void test_a_mark_before_the_first_pose_should_be_refused(void) {
  REFUSES(PF_ERROR_STATE, pf_mark_pose(slam));
  require_nothing(slam);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_mark_pose(NULL));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_motion_since_mark(NULL, &motion));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_motion_since_mark(slam, NULL));
}

/* Where the camera is now, in the frame of a pose before. */
static void relative(const pf_pose_t* K, const pf_pose_t* C, double p_KC[3]) {
  const double w = K->q_WC[0], x = -K->q_WC[1], y = -K->q_WC[2], z = -K->q_WC[3]; /* q_KW */
  const double d[3] = {C->p_WC[0] - K->p_WC[0], C->p_WC[1] - K->p_WC[1], C->p_WC[2] - K->p_WC[2]};
  const double t[3] = {2 * (y * d[2] - z * d[1]), 2 * (z * d[0] - x * d[2]), 2 * (x * d[1] - y * d[0])};
  p_KC[0] = d[0] + w * t[0] + y * t[2] - z * t[1];
  p_KC[1] = d[1] + w * t[1] + z * t[0] - x * t[2];
  p_KC[2] = d[2] + w * t[2] + x * t[1] - y * t[0];
}

static void test_the_motion_should_begin_at_zero_and_be_the_difference_of_poses_at_first(void) {
  pf_pose_t K, C;
  double p_KC[3];
  run(slam, 30);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &K));
  const int32_t rows = state_dim(slam);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_mark_pose(slam));
  TEST_ASSERT_EQUAL_INT(rows + 6, state_dim(slam));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_motion_since_mark(slam, &motion));
  TEST_ASSERT_EQUAL_INT64(STEP_NS * 30, motion.mark_t_ns);
  TEST_ASSERT_EQUAL_INT64(STEP_NS * 30, motion.t_ns);
  TEST_ASSERT_EQUAL_UINT32(1, motion.map_id);
  TEST_ASSERT_DOUBLE_WITHIN(rounding(), 1, motion.q_KC[0]);
  for (int i = 0; i < 3; ++i) TEST_ASSERT_DOUBLE_WITHIN(rounding(), 0, motion.p_KC[i]);
  for (int i = 0; i < 36; ++i) TEST_ASSERT_DOUBLE_WITHIN(rounding(), 0, motion.covariance[i]);
  for (int k = 30; k < 40; ++k) TEST_ASSERT_EQUAL_INT(PF_OK, push(slam, k));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_motion_since_mark(slam, &motion));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &C));
  TEST_ASSERT_EQUAL_INT64(STEP_NS * 30, motion.mark_t_ns);
  TEST_ASSERT_EQUAL_INT64(STEP_NS * 40, motion.t_ns);
  relative(&K, &C, p_KC); /* what was learnt since then moved K as well, by far less than the camera went */
  double size = 0, off = 0;
  for (int i = 0; i < 3; ++i) size += p_KC[i] * p_KC[i], off += pow(p_KC[i] - motion.p_KC[i], 2);
  TEST_ASSERT_TRUE(sqrt(size) > 0.05 && sqrt(off) < 0.01 * sqrt(size));
  for (int i = 0; i < 6; ++i) {
    TEST_ASSERT_TRUE(motion.covariance[7 * i] > 0);
    for (int j = 0; j < i; ++j)
      TEST_ASSERT_DOUBLE_WITHIN(0, motion.covariance[6 * j + i], motion.covariance[6 * i + j]);
  }
}

static void test_a_new_mark_should_replace_the_old_one(void) {
  run(slam, 20);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_mark_pose(slam));
  TEST_ASSERT_EQUAL_INT(PF_OK, push(slam, 20));
  const int32_t rows = state_dim(slam);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_mark_pose(slam));
  TEST_ASSERT_EQUAL_INT(rows, state_dim(slam));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_motion_since_mark(slam, &motion));
  TEST_ASSERT_EQUAL_INT64(STEP_NS * 21, motion.mark_t_ns);
  for (int i = 0; i < 36; ++i) TEST_ASSERT_DOUBLE_WITHIN(rounding(), 0, motion.covariance[i]);
}

static void test_a_reset_should_take_the_mark_along(void) {
  run(slam, 20);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_mark_pose(slam));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(slam));
  require_nothing(slam);
  run(slam, 20);
  require_nothing(slam);
}

/* Frames in which a few observations are seen, and so too few for a tracked frame. */
static pf_status_t push_few(pf_slam_t* to, int k) {
  pf_observation_t observations[POINTS];
  observe(k, observations);
  return pf_push_observations(to, STEP_NS * (k + 1), observations, 3);
}

static void test_a_mark_should_outlive_coasting_and_grow_uncertain(void) {
  run(slam, 30);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_mark_pose(slam));
  TEST_ASSERT_EQUAL_INT(PF_OK, push(slam, 30));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_motion_since_mark(slam, &motion));
  const pf_motion_t tracked = motion;
  for (int k = 31; k < 45; ++k)
    TEST_ASSERT_EQUAL_INT(PF_NOTE_COASTING, pf_push_observations(slam, STEP_NS * (k + 1), NULL, 0));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_motion_since_mark(slam, &motion));
  for (int i = 0; i < 6; ++i) TEST_ASSERT_TRUE(motion.covariance[7 * i] > 4 * tracked.covariance[7 * i]);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_mark_pose(slam)); /* of a prediction: still the difference of two poses */
  for (int k = 45; k < 100; ++k) push_few(slam, k);
  pf_state_t state;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_state(slam, &state));
  TEST_ASSERT_EQUAL_INT(PF_STATE_LOST, state);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_motion_since_mark(slam, &motion));
  TEST_ASSERT_EQUAL_INT64(STEP_NS * 45, motion.mark_t_ns);
}

/* A context whose state has so many rows, in a block of its own. */
static unsigned char* open_with(int32_t max_state_dim, pf_slam_t** to) {
  pf_config_t own = config;
  own.capacity.max_state_dim = max_state_dim;
  pf_memory_t bytes;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&own, &bytes));
  unsigned char* at = new_block(bytes.bytes, 0);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&own, at, bytes.bytes, to));
  return at;
}

/* The observations first .. end - 1. */
static pf_status_t push_range(pf_slam_t* to, int k, int first, int end) {
  pf_observation_t observations[POINTS];
  observe(k, observations);
  return pf_push_observations(to, STEP_NS * (k + 1), observations + first, (size_t)(end - first));
}

static void test_a_full_state_should_refuse_a_mark_where_everything_is_in_view(void) {
  pf_slam_t* const outer = slam;
  unsigned char* at = open_with(60, &slam);
  run(slam, 20); /* 60 rows hold fewer than the points that are shown, so all in the map are in view */
  TEST_ASSERT_TRUE(state_dim(slam) + 6 > 60);
  REFUSES(PF_ERROR_FULL, pf_mark_pose(slam));
  require_nothing(slam);
  TEST_ASSERT_NOT_NULL(strstr(pf_status_text(PF_ERROR_FULL), "room"));
  slam = outer;
  free_block(at);
}

static void test_a_full_state_should_evict_what_is_out_of_view_and_never_the_mark(void) {
  pf_slam_t* const outer = slam;
  unsigned char* at = open_with(60, &slam);
  run(slam, 20);
  TEST_ASSERT_EQUAL_INT(PF_OK, push_range(slam, 20, 4, 14)); /* the first four are out of view, and nothing is new */
  const int32_t before = state_dim(slam);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_mark_pose(slam));
  TEST_ASSERT_TRUE(state_dim(slam) <= 60 && state_dim(slam) <= before + 6);
  for (int k = 21; k < 60; ++k) {
    push_range(slam, k, k % 5, POINTS); /* others come and go */
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_motion_since_mark(slam, &motion));
    TEST_ASSERT_EQUAL_INT64(STEP_NS * 21, motion.mark_t_ns);
  }
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_mark_pose(slam)); /* the old mark's rows are its room */
  TEST_ASSERT_TRUE(state_dim(slam) <= 60);
  slam = outer;
  free_block(at);
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_a_mark_before_the_first_pose_should_be_refused);
  RUN_TEST(test_the_motion_should_begin_at_zero_and_be_the_difference_of_poses_at_first);
  RUN_TEST(test_a_new_mark_should_replace_the_old_one);
  RUN_TEST(test_a_reset_should_take_the_mark_along);
  RUN_TEST(test_a_mark_should_outlive_coasting_and_grow_uncertain);
  RUN_TEST(test_a_full_state_should_refuse_a_mark_where_everything_is_in_view);
  RUN_TEST(test_a_full_state_should_evict_what_is_out_of_view_and_never_the_mark);
  return UNITY_END();
}
