// A camera that is lost for minutes. The variances of its speed decayed for as long as that lasted, until they were no normal numbers any
// more; P was then repaired in frame after frame, and each repair raised what else it holds.
#include <planefold/planefold.h>

#include <cstdio>

#include "owned_context.h"
#include "unity.h"

void setUp() {}
void tearDown() {}

namespace {

constexpr int kFrames = 6000;
constexpr int64_t kFrame_ns = 33333333;
constexpr double kAnyRotation = 1.8;  // [rad] as in lib/src/slam/tuning.h

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

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_the_covariance_should_need_no_repair_when_lost_for_minutes);
  return UNITY_END();
}
