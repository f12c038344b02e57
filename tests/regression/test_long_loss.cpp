// A camera that is lost, for minutes or after an absurd speed. The variances of its speed decayed for as long as that lasted, until they
// were no normal numbers any more; P was then repaired in frame after frame, and each repair raised what else it holds.
#include <planefold/planefold.h>

#include <cmath>
#include <cstdio>

#include "owned_context.h"
#include "unity.h"

void setUp() {}
void tearDown() {}

namespace {

constexpr int kFrames = 6000;
constexpr int64_t kFrame_ns = 33333333;
constexpr double kAnyRotation = 1.8;  // [rad] as in lib/src/slam/tuning.h
constexpr double kSpeedDecay = 0.25;  // [s] likewise

void lose(int motion, const char* name) {
  pf_config_t config = pinhole_config();
  config.motion.model = motion;
  if (motion == PF_MOTION_INERTIAL) {
    config.capacity.max_imu_samples = 100;
    config.imu.gyro_density = 1e-3;
    config.imu.accel_density = 1e-2;
    config.imu.gyro_walk = 1e-5;
    config.imu.accel_walk = 1e-4;
  }
  OwnedContext context(config);
  pf_slam_t* slam = context.slam;
  pf_pose_t pose = {};
  double velocity_covariance[36] = {};
  pose.q_WC[0] = 1;
  for (int i = 0; i < 6; ++i) {
    pose.covariance[7 * i] = 1e-4;
    // The axes of each speed share half of their variance.
    for (int j = 0; j < 6; ++j) velocity_covariance[6 * i + j] = i == j ? 0.01 : i / 3 == j / 3 ? 0.005 : 0;
  }
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_pose(slam, &pose, velocity_covariance));
  for (int f = 1; f <= kFrames; ++f) {
    TEST_ASSERT_TRUE(pf_push_observations(slam, f * kFrame_ns, nullptr, 0) >= PF_OK);
    // The places where the camera was, which P keeps beside the body.
    if (f % 300 == 0) pf_mark_pose(slam);
  }
  pf_report_t report;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(slam, &report));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &pose));
  std::printf("%s: %d frames with a repair; variances of the rotation %.3g, of the position %.3g\n", name,
              static_cast<int>(report.covariance_repairs), pose.covariance[0], pose.covariance[21]);
  TEST_ASSERT_EQUAL_INT(PF_STATE_LOST, report.state);
  TEST_ASSERT_EQUAL_INT(0, report.covariance_repairs);
  for (int i = 0; i < 3; ++i) TEST_ASSERT_TRUE(pose.covariance[7 * i] < 2 * kAnyRotation * kAnyRotation);
}

void test_the_covariance_should_need_no_repair_when_lost_for_minutes() {
  lose(PF_MOTION_CONSTANT_VELOCITY, "constant velocity");
  lose(PF_MOTION_INERTIAL, "inertial, without samples");
}

/// A control input of 4,000 rad/s, and nothing seen after it. The square of a speed that decays became variance without end: thousands of
/// rad, beside which float cannot hold what the next images tell. It may be what leads to any rotation in a frame, and then decays.
void test_a_rotation_should_stay_any_rotation_when_an_absurd_speed_decays() {
  OwnedContext context(pinhole_config());
  pf_slam_t* slam = context.slam;
  pf_pose_t pose = {};
  pose.q_WC[0] = 1;
  for (int i = 0; i < 6; ++i) pose.covariance[7 * i] = 1e-4;
  double velocity_covariance[36] = {};
  for (int i = 0; i < 6; ++i) velocity_covariance[7 * i] = 0.01;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_pose(slam, &pose, velocity_covariance));
  TEST_ASSERT_TRUE(pf_push_observations(slam, kFrame_ns, nullptr, 0) >= PF_OK);
  const double dv_C[3] = {}, dw_C[3] = {0, 2400, 3200};
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_control(slam, dv_C, dw_C));
  double largest = 0;
  for (int f = 2; f <= 300; ++f) {
    TEST_ASSERT_TRUE(pf_push_observations(slam, f * kFrame_ns, nullptr, 0) >= PF_OK);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &pose));
    for (int i = 0; i < 3; ++i) largest = std::fmax(largest, std::sqrt(pose.covariance[7 * i]));
  }
  std::printf("an absurd speed: %.3g rad\n", largest);
  TEST_ASSERT_TRUE(largest > kAnyRotation && largest < kAnyRotation * (1 + kSpeedDecay / (1e-9 * kFrame_ns)));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_the_covariance_should_need_no_repair_when_lost_for_minutes);
  RUN_TEST(test_a_rotation_should_stay_any_rotation_when_an_absurd_speed_decays);
  return UNITY_END();
}
