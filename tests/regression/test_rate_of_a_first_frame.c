/* The first frame of a map was not predicted to, so its rate was zero: at 0.8 rad/s its rows, and with them its bearings, were 12 mrad
 * off at most, at a covariance that allowed for 0.3. */
#include <math.h>

#include "support/inertial_unit.h"
#include "support/small_context.h"

#define IMU_NS INT64_C(5000000)
#define RATE 0.8 /* [rad/s] about the y axis of the camera, which is that of the unit */

static void begin(void) {
  use_inertial_unit(&config, 100);
  config.camera.readout_s = 0.03;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
  free_block(block);
  block = new_block(need.bytes, 0x55);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, need.bytes, &slam));
}

/* Samples every 5 ms, the last one at the time of the frame. */
static void push_samples(int64_t frame_ns, int count) {
  for (int i = 1; i <= count; ++i) {
    const pf_imu_sample_t sample = {frame_ns - IMU_NS * (count - i), {0, RATE, 0}, {0, -9.81, 0}};
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_imu(slam, &sample, 1));
  }
}

/* Where the row of a turning camera sees a direction at an angle from its axis, in the plane of x and z; y rows from the middle. */
static void see(double angle, double y, double pixel[2]) {
  const double tau = config.camera.readout_s * ((y + 0.5) / HEIGHT - 0.5);
  const double p_C[3] = {sin(angle - RATE * tau), 0, cos(angle - RATE * tau)};
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_camera_project(&config.camera, p_C, pixel));
  pixel[1] = y;
}

static void require_rate(int samples) {
  const double rows[4] = {5, 40, 80, 115};
  pf_observation_t seen[4];
  pf_feature_t features[30];
  pf_pose_t pose;
  size_t count = 0;
  begin();
  push_samples(STEP_NS, samples);
  for (uint32_t i = 0; i < 4; ++i) {
    seen[i].id = i;
    seen[i].sigma_px = 0;
    see(0.1 * i - 0.15, rows[i], seen[i].pixel);
  }
  TEST_ASSERT_TRUE(pf_push_observations(slam, STEP_NS, seen, 4) >= PF_OK);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &pose));
  TEST_ASSERT_DOUBLE_WITHIN(1e-3, RATE, pose.w_C[1]);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_features(slam, features, 30, &count));
  TEST_ASSERT_EQUAL_size_t(4, count);
  for (size_t i = 0; i < count; ++i) {
    const double angle = atan2(features[i].p_W[0], features[i].p_W[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.1 * features[i].external_id - 0.15, angle);
  }
}

static void test_rows_of_a_first_frame_should_be_turned_by_its_samples(void) { require_rate(5); }

static void test_the_first_sample_of_all_should_turn_them_too(void) { require_rate(1); }

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_rows_of_a_first_frame_should_be_turned_by_its_samples);
  RUN_TEST(test_the_first_sample_of_all_should_turn_them_too);
  return UNITY_END();
}
