// Where pf-capture draws what a camera sees whose rows are read out one after the other.
#include "../../examples/capture/maths.cpp"
#include "../../examples/capture/rows.cpp"
#include "../../examples/capture/rows.h"
#include "support/seeded_random.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kTrials = 200;

struct Case {
  pf_camera_t camera{
      PF_CAMERA_RADTAN,   640, 480, 500, 510, 320, 240, {-0.1, 0.02, 1e-4, -1e-4, 0}, 0.03, PF_CAMERA_EXACT,
      PF_TIMESTAMPS_REAL, 0,   0,   0,   {}};
  pf_pose_t pose{};
  capture::Vec3 p_C{};

  explicit Case(SeededRandom& random) {
    Eigen::Quaterniond q(random.normal(), random.normal(), random.normal(), random.normal());
    q.normalize();
    const double wxyz[4] = {q.w(), q.x(), q.y(), q.z()};
    for (int i = 0; i < 4; ++i) pose.q_WC[i] = wxyz[i];
    for (int i = 0; i < 3; ++i) {
      pose.p_WC[i] = random.normal();
      pose.v_W[i] = 0.5 * random.normal();
      pose.w_C[i] = 0.7 * random.normal();
    }
    const double z = random.uniform(0.5, 3);
    p_C = {z * random.uniform(-0.5, 0.5), z * random.uniform(-0.35, 0.35), z};
  }
};

void test_pixel_should_be_what_its_own_row_sees() {
  SeededRandom random(611);
  double farthest = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Case c(random);
    double pixel[2], middle[2], expected[2];
    TEST_ASSERT_TRUE(capture::project_row(c.camera, c.pose, c.p_C, pixel));
    const double tau = c.camera.readout_s * ((pixel[1] + 0.5) / c.camera.height - 0.5);
    const Eigen::Quaterniond q(c.pose.q_WC[0], c.pose.q_WC[1], c.pose.q_WC[2], c.pose.q_WC[3]);
    const Eigen::Map<const Eigen::Vector3d> p_WC(c.pose.p_WC), v_W(c.pose.v_W), w_C(c.pose.w_C), p_C(c.p_C.data());
    const Eigen::Vector3d p_W = q * p_C + p_WC;
    const Eigen::Quaterniond turned = q * Eigen::AngleAxisd(w_C.norm() * tau, w_C.normalized());
    const Eigen::Vector3d seen = turned.conjugate() * (p_W - p_WC - v_W * tau);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_camera_project(&c.camera, seen.data(), expected));
    TEST_ASSERT_DOUBLE_WITHIN(0.05, expected[0], pixel[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, expected[1], pixel[1]);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_camera_project(&c.camera, c.p_C.data(), middle));
    farthest = std::max(farthest, std::hypot(pixel[0] - middle[0], pixel[1] - middle[1]));
  }
  TEST_ASSERT_TRUE(farthest > 5.0);  // what the rows are about
}

void test_pixel_should_be_that_of_the_frame_when_the_shutter_is_global() {
  SeededRandom random(612);
  for (int trial = 0; trial < kTrials; ++trial) {
    Case c(random);
    c.camera.readout_s = 0;
    double pixel[2], expected[2];
    TEST_ASSERT_TRUE(capture::project_row(c.camera, c.pose, c.p_C, pixel));
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_camera_project(&c.camera, c.p_C.data(), expected));
    TEST_ASSERT_EQUAL_DOUBLE(expected[0], pixel[0]);
    TEST_ASSERT_EQUAL_DOUBLE(expected[1], pixel[1]);
  }
}

void test_point_should_go_to_the_camera_and_not_be_drawn_when_it_lies_behind() {
  SeededRandom random(613);
  const Case c(random);
  const Eigen::Quaterniond q(c.pose.q_WC[0], c.pose.q_WC[1], c.pose.q_WC[2], c.pose.q_WC[3]);
  const Eigen::Vector3d p_W = q * Eigen::Vector3d(0.1, 0.2, -1) + Eigen::Map<const Eigen::Vector3d>(c.pose.p_WC);
  const capture::Vec3 p_C = capture::to_camera(c.pose, {p_W.x(), p_W.y(), p_W.z()});
  double pixel[2];
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.1, p_C[0]);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, -1, p_C[2]);
  TEST_ASSERT_FALSE(capture::project_row(c.camera, c.pose, p_C, pixel));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_pixel_should_be_what_its_own_row_sees);
  RUN_TEST(test_pixel_should_be_that_of_the_frame_when_the_shutter_is_global);
  RUN_TEST(test_point_should_go_to_the_camera_and_not_be_drawn_when_it_lies_behind);
  return UNITY_END();
}
