/* Anchors of a context that takes observations: when they can be set, what is refused, where they stay and when they go. */
#include <math.h>
#include <planefold/planefold.h>
#include <string.h>

#include "small_context.h"

static pf_anchor_t anchor;

static pf_pose_t pose_now(const pf_slam_t* of) {
  pf_pose_t pose;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(of, &pose));
  return pose;
}

static uint32_t add_pose(pf_slam_t* to) {
  const pf_pose_t pose = pose_now(to);
  uint32_t id = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_anchor_pose(to, &pose, &id));
  return id;
}

static pf_anchor_t anchor_of(const pf_slam_t* of, uint32_t id) {
  pf_anchor_t out;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_anchor(of, id, &out));
  return out;
}

static int32_t state_dim(const pf_slam_t* of) {
  pf_report_t report;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(of, &report));
  return report.state_dim;
}

static size_t count_of(const pf_slam_t* of) {
  size_t count = 77;
  TEST_ASSERT_TRUE(pf_get_anchors(of, NULL, 0, &count) >= PF_OK);
  return count;
}

static double rounding(void) { return config.scalar == PF_SCALAR_FLOAT ? 1e-5 : 1e-12; }

static void test_null_and_unknown_should_be_refused(void) {
  pf_pose_t pose;
  pf_hit_t hit;
  uint32_t id = 77;
  size_t count;
  pf_anchor_t before;
  memset(&pose, 0, sizeof pose);
  memset(&hit, 0, sizeof hit);
  memset(&anchor, 7, sizeof anchor);
  before = anchor;
  pose.q_WC[0] = 1;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_add_anchor_pose(NULL, &pose, &id));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_add_anchor_hit(NULL, &hit, &id));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_anchor(NULL, 1, &anchor));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_anchors(NULL, NULL, 0, &count));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_remove_anchor(NULL, 1));
  REFUSES(PF_ERROR_NULL, pf_add_anchor_pose(slam, NULL, &id));
  REFUSES(PF_ERROR_NULL, pf_add_anchor_pose(slam, &pose, NULL));
  REFUSES(PF_ERROR_NULL, pf_add_anchor_hit(slam, NULL, &id));
  REFUSES(PF_ERROR_NULL, pf_add_anchor_hit(slam, &hit, NULL));
  REFUSES(PF_ERROR_NULL, pf_get_anchor(slam, 1, NULL));
  REFUSES(PF_ERROR_NULL, pf_get_anchors(slam, NULL, 3, &count));
  REFUSES(PF_ERROR_NULL, pf_get_anchors(slam, &anchor, 1, NULL));
  REFUSES(PF_NOTE_NOTHING, pf_get_anchor(slam, 1, &anchor));
  REFUSES(PF_NOTE_NOTHING, pf_get_anchor(slam, 0, &anchor));
  REFUSES(PF_NOTE_NOTHING, pf_remove_anchor(slam, 1));
  REFUSES(PF_NOTE_NOTHING, pf_remove_anchor(slam, 0));
  REFUSES(PF_NOTE_NOTHING, pf_add_anchor_hit(slam, &hit, &id));
  REFUSES(PF_ERROR_STATE, pf_add_anchor_pose(slam, &pose, &id)); /* before the first frame */
  TEST_ASSERT_EQUAL_UINT32(77, id);
  TEST_ASSERT_EQUAL_MEMORY(&before, &anchor, sizeof anchor);
  TEST_ASSERT_EQUAL_size_t(0, count_of(slam));
}

static void test_numbers_out_of_their_domain_should_be_refused(void) {
  uint32_t id = 77;
  run(slam, 30);
  for (int i = 0; i < 7; ++i) {
    pf_pose_t pose = pose_now(slam);
    double* const number = i < 4 ? &pose.q_WC[i] : &pose.p_WC[i - 4];
    *number = NAN;
    REFUSES(PF_ERROR_NONFINITE, pf_add_anchor_pose(slam, &pose, &id));
    *number = -INFINITY;
    REFUSES(PF_ERROR_NONFINITE, pf_add_anchor_pose(slam, &pose, &id));
    *number = 2e6;
    REFUSES(PF_ERROR_RANGE, pf_add_anchor_pose(slam, &pose, &id));
  }
  pf_pose_t pose = pose_now(slam);
  memset(pose.q_WC, 0, sizeof pose.q_WC);
  REFUSES(PF_ERROR_RANGE, pf_add_anchor_pose(slam, &pose, &id));
  pf_hit_t hit;
  memset(&hit, 0, sizeof hit);
  hit.p_W[1] = NAN;
  REFUSES(PF_ERROR_NONFINITE, pf_add_anchor_hit(slam, &hit, &id));
  hit.p_W[1] = 1e7;
  REFUSES(PF_ERROR_RANGE, pf_add_anchor_hit(slam, &hit, &id));
  hit.p_W[1] = 0;
  hit.plane = 4000000000u;
  REFUSES(PF_NOTE_NOTHING, pf_add_anchor_hit(slam, &hit, &id));
  TEST_ASSERT_EQUAL_UINT32(77, id);
  TEST_ASSERT_EQUAL_size_t(0, count_of(slam));
}

/* An anchor at the camera is the camera, with its covariance; its own in the pose that is passed in does not count. */
static void test_an_anchor_at_the_camera_should_be_as_sure_as_the_camera(void) {
  run(slam, 30);
  pf_pose_t pose = pose_now(slam);
  const pf_pose_t camera = pose;
  const int32_t rows = state_dim(slam);
  uint32_t id = 0;
  pose.covariance[0] = NAN;
  pose.map_id = 55;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_anchor_pose(slam, &pose, &id));
  TEST_ASSERT_EQUAL_UINT32(1, id);
  TEST_ASSERT_EQUAL_INT(rows + 6, state_dim(slam));
  anchor = anchor_of(slam, id);
  TEST_ASSERT_EQUAL_UINT32(1, anchor.id);
  TEST_ASSERT_EQUAL_UINT32(1, anchor.map_id);
  TEST_ASSERT_EQUAL_UINT32(0, anchor.plane);
  TEST_ASSERT_EQUAL_UINT32(0, anchor.reserved);
  for (int i = 0; i < 4; ++i) TEST_ASSERT_DOUBLE_WITHIN(rounding(), camera.q_WC[i], anchor.q_WA[i]);
  for (int i = 0; i < 3; ++i) TEST_ASSERT_DOUBLE_WITHIN(rounding(), camera.p_WC[i], anchor.p_WA[i]);
  for (int i = 0; i < 6; ++i)
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * camera.covariance[7 * i], camera.covariance[7 * i], anchor.covariance[7 * i]);
  /* Of the same frame, elsewhere: the same six rows, and a lever. */
  pose.p_WC[2] += 3;
  uint32_t far = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_anchor_pose(slam, &pose, &far));
  TEST_ASSERT_EQUAL_UINT32(2, far);
  TEST_ASSERT_EQUAL_INT(rows + 6, state_dim(slam));
  const pf_anchor_t lever = anchor_of(slam, far);
  TEST_ASSERT_TRUE(lever.covariance[21] > anchor.covariance[21]);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < i; ++j) TEST_ASSERT_DOUBLE_WITHIN(0, lever.covariance[6 * j + i], lever.covariance[6 * i + j]);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_remove_anchor(slam, id));
  TEST_ASSERT_EQUAL_INT(rows + 6, state_dim(slam));
  TEST_ASSERT_EQUAL_INT(PF_NOTE_NOTHING, pf_remove_anchor(slam, id));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_remove_anchor(slam, far));
  TEST_ASSERT_EQUAL_INT(rows, state_dim(slam));
}

static void test_anchors_should_be_listed_and_refused_when_full(void) {
  pf_anchor_t all[8];
  size_t count = 0;
  uint32_t id = 77;
  run(slam, 30);
  for (uint32_t k = 1; k <= 8; ++k) TEST_ASSERT_EQUAL_UINT32(k, add_pose(slam));
  const pf_pose_t pose = pose_now(slam);
  REFUSES(PF_ERROR_FULL, pf_add_anchor_pose(slam, &pose, &id));
  TEST_ASSERT_EQUAL_UINT32(77, id);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_remove_anchor(slam, 3));
  TEST_ASSERT_EQUAL_UINT32(9, add_pose(slam)); /* no id comes twice */
  TEST_ASSERT_EQUAL_INT(PF_NOTE_TRUNCATED, pf_get_anchors(slam, all, 5, &count));
  TEST_ASSERT_EQUAL_size_t(8, count);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_anchors(slam, all, 8, &count));
  for (size_t i = 0; i < count; ++i) {
    anchor = anchor_of(slam, all[i].id);
    TEST_ASSERT_EQUAL_MEMORY(&anchor, &all[i], sizeof anchor);
  }
}

static void test_without_capacity_there_should_be_no_room(void) {
  pf_slam_t* const outer = slam;
  pf_config_t own = config;
  pf_memory_t bytes;
  uint32_t id = 0;
  own.capacity.max_anchors = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&own, &bytes));
  TEST_ASSERT_TRUE(bytes.bytes < need.bytes);
  unsigned char* at = new_block(bytes.bytes, 0);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&own, at, bytes.bytes, &slam));
  run(slam, 30);
  const pf_pose_t pose = pose_now(slam);
  REFUSES(PF_ERROR_FULL, pf_add_anchor_pose(slam, &pose, &id));
  slam = outer;
  free_block(at);
}

static void test_a_full_state_should_refuse_an_anchor_where_everything_is_in_view(void) {
  pf_slam_t* const outer = slam;
  pf_config_t own = config;
  pf_memory_t bytes;
  uint32_t id = 0;
  own.capacity.max_state_dim = 60;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&own, &bytes));
  unsigned char* at = new_block(bytes.bytes, 0);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&own, at, bytes.bytes, &slam));
  run(slam, 20);
  const pf_pose_t pose = pose_now(slam);
  REFUSES(PF_ERROR_FULL, pf_add_anchor_pose(slam, &pose, &id));
  TEST_ASSERT_EQUAL_size_t(0, count_of(slam));
  slam = outer;
  free_block(at);
}

/* A reset takes all along; a coasting camera sets none and keeps those that there are. */
static void test_a_coasting_camera_should_set_none_and_lose_none(void) {
  uint32_t id = 77;
  run(slam, 30);
  const uint32_t first = add_pose(slam);
  const pf_anchor_t before = anchor_of(slam, first);
  for (int k = 30; k < 40; ++k)
    TEST_ASSERT_EQUAL_INT(PF_NOTE_COASTING, pf_push_observations(slam, STEP_NS * (k + 1), NULL, 0));
  const pf_pose_t pose = pose_now(slam);
  REFUSES(PF_ERROR_STATE, pf_add_anchor_pose(slam, &pose, &id));
  anchor = anchor_of(slam, first);
  TEST_ASSERT_EQUAL_UINT32(1, anchor.map_id);
  /* Points that are folded into a plane still tell a little of where cameras were. */
  for (int i = 0; i < 3; ++i) TEST_ASSERT_DOUBLE_WITHIN(1e-4, before.p_WA[i], anchor.p_WA[i]);
  for (int i = 0; i < 6; ++i)
    TEST_ASSERT_TRUE(anchor.covariance[7 * i] < 1.001 * before.covariance[7 * i] &&
                     anchor.covariance[7 * i] > 0.5 * before.covariance[7 * i]);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(slam));
  TEST_ASSERT_EQUAL_size_t(0, count_of(slam));
  REFUSES(PF_NOTE_NOTHING, pf_get_anchor(slam, first, &anchor));
}

/* What a camera learns of its own past moves an anchor, and makes it surer. */
static void test_an_anchor_should_become_surer_with_the_map(void) {
  run(slam, 12);
  const uint32_t id = add_pose(slam);
  const pf_anchor_t before = anchor_of(slam, id);
  for (int k = 12; k < 60; ++k) TEST_ASSERT_TRUE(push(slam, k) >= PF_OK);
  anchor = anchor_of(slam, id);
  TEST_ASSERT_TRUE(anchor.covariance[21] < before.covariance[21]);
  TEST_ASSERT_TRUE(anchor.p_WA[0] != before.p_WA[0]);
}

static pf_status_t seen_from_log[3];
static pf_slam_t* logging;

static void ask_from_log(void* user, const char* line) {
  pf_pose_t pose;
  uint32_t id;
  (void)user, (void)line;
  if (logging == NULL) return;
  memset(&pose, 0, sizeof pose);
  pose.q_WC[0] = 1;
  seen_from_log[0] = pf_add_anchor_pose(logging, &pose, &id);
  seen_from_log[1] = pf_remove_anchor(logging, 1);
  seen_from_log[2] = pf_get_anchor(logging, 1, &anchor);
}

static void test_a_callback_should_ask_and_not_change(void) {
  pf_config_t own = config;
  pf_memory_t bytes;
  pf_slam_t* to = NULL;
  own.log = ask_from_log;
  own.motion.coast_s = 0.1;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&own, &bytes));
  unsigned char* at = new_block(bytes.bytes, 0);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&own, at, bytes.bytes, &to));
  run(to, 30);
  TEST_ASSERT_EQUAL_UINT32(1, add_pose(to));
  logging = to;
  for (int k = 30; k < 40; ++k)
    TEST_ASSERT_TRUE(pf_push_observations(to, STEP_NS * (k + 1), NULL, 0) > PF_OK); /* says that it is lost */
  logging = NULL;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, seen_from_log[0]);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, seen_from_log[1]);
  TEST_ASSERT_EQUAL_INT(PF_OK, seen_from_log[2]);
  free_block(at);
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_null_and_unknown_should_be_refused);
  RUN_TEST(test_numbers_out_of_their_domain_should_be_refused);
  RUN_TEST(test_an_anchor_at_the_camera_should_be_as_sure_as_the_camera);
  RUN_TEST(test_anchors_should_be_listed_and_refused_when_full);
  RUN_TEST(test_without_capacity_there_should_be_no_room);
  RUN_TEST(test_a_full_state_should_refuse_an_anchor_where_everything_is_in_view);
  RUN_TEST(test_a_coasting_camera_should_set_none_and_lose_none);
  RUN_TEST(test_an_anchor_should_become_surer_with_the_map);
  RUN_TEST(test_a_callback_should_ask_and_not_change);
  return UNITY_END();
}
