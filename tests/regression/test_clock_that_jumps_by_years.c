/* A clock of frames and inertial samples that jumps by 44 years: what lies between can be neither bridged nor coasted through, so that the
 * camera is lost or found again, and no variance is one that no camera could have. That of the rotation reached 1e17. */
#include <stdio.h>

#include "support/inertial_unit.h"
#include "support/small_context.h"

#define IMU_NS INT64_C(5000000)
#define YEARS_NS (44 * INT64_C(31556952) * INT64_C(1000000000))
#define BEFORE 90
#define FRAMES 250

static const double largest_rad = 10, largest_m = 1e4; /* sigmas */

static void use_inertial_model(void) {
  use_inertial_unit(&config, 100);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
  free_block(block);
  block = new_block(need.bytes, 0x55);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, need.bytes, &slam));
}

static void require_possible(const pf_pose_t* pose, int frame) {
  for (int i = 0; i < 6; ++i) {
    const double variance = pose->covariance[7 * i], most = i < 3 ? largest_rad : largest_m;
    char line[100];
    snprintf(line, sizeof(line), "frame %d: variance %d of the pose is %g", frame, i, variance);
    TEST_ASSERT_TRUE_MESSAGE(variance <= most * most, line);
  }
}

/* moves: the camera goes sideways, and its samples say so. shown: points that are seen behind the jump. Returns the status of the
 * first frame there. */
static pf_status_t run_across(int moves, size_t shown) {
  pf_status_t first = PF_OK;
  int64_t sample_ns = 0;
  for (int k = 0; k < FRAMES; ++k) {
    const int64_t shift_ns = k < BEFORE ? 0 : YEARS_NS, t_ns = STEP_NS * k;
    for (; sample_ns <= t_ns; sample_ns += IMU_NS) {
      const double wave = 1e-3 * ((double)(sample_ns / IMU_NS % 3) - 1);
      const pf_imu_sample_t sample = {sample_ns + shift_ns, {wave, 0, -wave}, {0, -9.81 + wave, 0}};
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_imu(slam, &sample, 1));
    }
    pf_observation_t seen[POINTS];
    const size_t count = observe(moves ? k : 0, seen);
    const pf_status_t status = pf_push_observations(slam, t_ns + shift_ns, seen, k < BEFORE ? count : shown);
    TEST_ASSERT_TRUE(status >= PF_OK);
    if (k == BEFORE) first = status;
    pf_pose_t pose;
    if (pf_get_pose(slam, &pose) == PF_OK) require_possible(&pose, k);
    pf_inertial_t unit;
    if (pf_get_inertial(slam, &unit) == PF_OK)
      for (int i = 2; i < 8; ++i) TEST_ASSERT_TRUE_MESSAGE(unit.covariance[9 * i] <= 1e4, "variance of a bias");
  }
  return first;
}

static void test_a_jump_in_motion_should_leave_variances_that_a_camera_can_have(void) {
  use_inertial_model();
  run_across(1, POINTS);
}

static void test_a_jump_at_rest_should_leave_variances_that_a_camera_can_have(void) {
  use_inertial_model();
  run_across(0, POINTS);
}

static void test_a_jump_into_a_place_without_features_should_end_lost(void) {
  for (int moves = 0; moves < 2; ++moves) {
    use_inertial_model();
    TEST_ASSERT_EQUAL_INT(PF_NOTE_LOST, run_across(moves, 0));
    pf_state_t state;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_state(slam, &state));
    TEST_ASSERT_EQUAL_INT(PF_STATE_LOST, state);
  }
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_a_jump_in_motion_should_leave_variances_that_a_camera_can_have);
  RUN_TEST(test_a_jump_at_rest_should_leave_variances_that_a_camera_can_have);
  RUN_TEST(test_a_jump_into_a_place_without_features_should_end_lost);
  return UNITY_END();
}
