// Pose from the corners of a rectangle and from known points: exactness, honesty, ambiguity, refusals.
#include <cmath>
#include <cstdio>
#include <limits>

#include "geometry/planar_pose.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"
#include "same.h"
#include "support/seeded_random.h"
#include "support/test_cameras.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr bool kFloat = sizeof(Scalar) == 4;
constexpr Scalar kWidth = Scalar(0.1832), kHeight = Scalar(0.1295);
constexpr Scalar kMost = std::numeric_limits<Scalar>::max();

/// A camera at `distance` that sees the rectangle's centre, `slant` off its normal, from the side `around`, rolled.
PoseEstimate viewpoint(double distance, double slant, double around, double roll, const Vec3& off) {
  PoseEstimate pose;
  const Vec3 axis(static_cast<Scalar>(std::cos(around)), static_cast<Scalar>(std::sin(around)), 0);
  const Quat turn = exp_so3(axis * static_cast<Scalar>(slant));
  pose.q_WC = turn * exp_so3(Vec3(0, 0, static_cast<Scalar>(roll)));
  pose.p_WC = turn * Vec3(0, 0, static_cast<Scalar>(-distance)) + off;
  return pose;
}

bool see(const Camera& camera, const PoseEstimate& pose, const Vec3* points, int count, Vec2* pixels) {
  for (int i = 0; i < count; ++i) {
    if (!project_from_pose(camera, pose.q_WC, pose.p_WC, points[i], pose.p_WC, &pixels[i])) return false;
  }
  return true;
}

Vec6 error_of(const PoseEstimate& truth, const PoseEstimate& estimate) {
  Vec6 e;
  e << log_so3(truth.q_WC * estimate.q_WC.conjugate()), truth.p_WC - estimate.p_WC;
  return e;
}

double nees(const Vec6& e, const Mat6& P) {
  SmallCholesky<6> factored;
  TEST_ASSERT_TRUE(factored.factor(P));
  return static_cast<double>(e.dot(factored.solve<1>(e)));
}

void test_rectangle_pose_should_be_exact_when_the_corners_are() {
  SeededRandom random(11);
  Vec3 points[4];
  rectangle_points(kWidth, kHeight, points);
  for (int k = 0; k < kTestCameras; ++k) {
    const Camera camera = test_camera_of(k);
    double worst = 0;
    for (int trial = 0; trial < 200; ++trial) {
      const PoseEstimate truth = viewpoint(random.uniform(0.3, 1.0), trial % 10 == 0 ? 0 : random.uniform(0, 1.2),
                                           random.uniform(0, 6.28), random.uniform(-3, 3), random.normals<3>(0.02));
      Vec2 pixels[4];
      if (!see(camera, truth, points, 4, pixels)) continue;
      PoseEstimate estimate;
      Scalar second;
      TEST_ASSERT_TRUE(rectangle_pose(camera, kWidth, kHeight, pixels, Scalar(0.2), &estimate, &second));
      worst = std::fmax(worst, static_cast<double>(error_of(truth, estimate).norm()));
      TEST_ASSERT_TRUE(second >= estimate.rms_px);
    }
    std::printf("model %d: worst error %.3g\n", k + 1, worst);
    TEST_ASSERT_DOUBLE_WITHIN(kFloat ? 2e-2 : 1e-8, 0, worst);
  }
}

void test_rectangle_pose_should_be_as_sure_as_it_says_when_the_corners_are_noisy() {
  SeededRandom random(12);
  const Camera camera = division_camera();
  Vec3 points[4];
  rectangle_points(kWidth, kHeight, points);
  double sum = 0, sum_frontal = 0;
  int over = 0, count = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const bool frontal = trial % 2 == 0;
    const PoseEstimate truth = viewpoint(0.6, frontal ? random.uniform(0, 0.1) : random.uniform(0.5, 0.9),
                                         random.uniform(0, 6.28), random.uniform(-0.3, 0.3), random.normals<3>(0.02));
    Vec2 pixels[4];
    TEST_ASSERT_TRUE(see(camera, truth, points, 4, pixels));
    for (Vec2& pixel : pixels) pixel += random.normals<2>(0.2);
    PoseEstimate estimate;
    Scalar second;
    TEST_ASSERT_TRUE(rectangle_pose(camera, kWidth, kHeight, pixels, Scalar(0.2), &estimate, &second));
    const double value = nees(error_of(truth, estimate), estimate.covariance);
    (frontal ? sum_frontal : sum) += value / 1000;
    if (value > 16.81) ++over;  // 99 % of chi square with 6 degrees of freedom
    ++count;
  }
  std::printf("NEES slanted %.2f, frontal %.2f (6), above the 99 %% bound: %d of %d\n", sum, sum_frontal, over, count);
  TEST_ASSERT_DOUBLE_WITHIN(1.0, 6, sum);
  TEST_ASSERT_DOUBLE_WITHIN(2.5, 6, sum_frontal);
  TEST_ASSERT_LESS_OR_EQUAL_INT(count / 25, over);
}

void test_covariance_should_widen_when_the_mirrored_pose_fits_as_well() {
  // From far away perspective is lost in the noise: the two normals cannot be told apart.
  const Camera camera = pinhole_camera();
  Vec3 points[4];
  rectangle_points(kWidth, kHeight, points);
  const PoseEstimate truth = viewpoint(6, 0.5, 1.0, 0, Vec3::Zero());
  Vec2 pixels[4];
  TEST_ASSERT_TRUE(see(camera, truth, points, 4, pixels));
  PoseEstimate estimate, alone;
  Scalar second;
  TEST_ASSERT_TRUE(rectangle_pose(camera, kWidth, kHeight, pixels, Scalar(0.3), &estimate, &second));
  TEST_ASSERT_TRUE(second < Scalar(0.3));
  alone = estimate;
  TEST_ASSERT_TRUE(refine_pose(camera, points, pixels, 4, Scalar(0.3), &alone));
  // The mirrored camera is 2 sin(0.5) x 6 m away.
  const Scalar spread = estimate.covariance.bottomRightCorner<3, 3>().trace();
  const Scalar spread_alone = alone.covariance.bottomRightCorner<3, 3>().trace();
  TEST_ASSERT_TRUE(spread > spread_alone + Scalar(4));
}

void test_refined_pose_should_reach_the_truth_when_the_points_are_not_in_a_plane() {
  SeededRandom random(13);
  const Camera camera = radtan_camera();
  for (int trial = 0; trial < 100; ++trial) {
    const int count = trial % 13 + 4;
    Vec3 points[kPoseMaxPoints];
    Vec2 pixels[kPoseMaxPoints];
    for (int i = 0; i < count; ++i) points[i] = random.normals<3>(0.3);
    const PoseEstimate truth = viewpoint(2.5, 0.4, 2, 0.2, Vec3::Zero());
    TEST_ASSERT_TRUE(see(camera, truth, points, count, pixels));
    PoseEstimate estimate = truth;
    estimate.q_WC = (exp_so3(random.normals<3>(0.05)) * truth.q_WC).normalized();
    estimate.p_WC += random.normals<3>(0.1);
    TEST_ASSERT_TRUE(refine_pose(camera, points, pixels, count, Scalar(0.5), &estimate));
    // Four points in space may have a second solution nearby; its residuals give it away.
    if (count == 4 && estimate.rms_px > Scalar(0.01)) continue;
    TEST_ASSERT_DOUBLE_WITHIN(kFloat ? 5e-3 : 1e-8, 0, static_cast<double>(error_of(truth, estimate).norm()));
  }
}

void test_pose_should_be_refused_when_the_input_makes_no_sense() {
  const Camera camera = pinhole_camera();
  PoseEstimate estimate;
  Scalar second = -7;
  const Scalar nan = std::numeric_limits<Scalar>::quiet_NaN();
  const Vec2 good[4] = {Vec2(200, 150), Vec2(400, 150), Vec2(400, 290), Vec2(200, 290)};
  TEST_ASSERT_TRUE(rectangle_pose(camera, kWidth, kHeight, good, 1, &estimate));
  estimate = PoseEstimate();
  const Vec2 mirrored[4] = {good[1], good[0], good[3], good[2]};
  TEST_ASSERT_FALSE(rectangle_pose(camera, kWidth, kHeight, mirrored, 1, &estimate, &second));
  const Vec2 crossed[4] = {good[0], good[2], good[1], good[3]};
  TEST_ASSERT_FALSE(rectangle_pose(camera, kWidth, kHeight, crossed, 1, &estimate, &second));
  const Vec2 line[4] = {Vec2(200, 150), Vec2(300, 150), Vec2(400, 150), Vec2(200, 290)};
  TEST_ASSERT_FALSE(rectangle_pose(camera, kWidth, kHeight, line, 1, &estimate, &second));
  const Vec2 not_a_number[4] = {good[0], good[1], Vec2(nan, 3), good[3]};
  TEST_ASSERT_FALSE(rectangle_pose(camera, kWidth, kHeight, not_a_number, 1, &estimate, &second));
  TEST_ASSERT_FALSE(rectangle_pose(camera, -kWidth, kHeight, good, 1, &estimate, &second));
  TEST_ASSERT_FALSE(rectangle_pose(camera, nan, kHeight, good, 1, &estimate, &second));
  TEST_ASSERT_FALSE(rectangle_pose(camera, kMost, kMost, good, 1, &estimate, &second));
  TEST_ASSERT_SAME(Scalar(-7), second);
  TEST_ASSERT_SAME(Vec3::Zero(), estimate.p_WC);
  Vec3 points[4];
  rectangle_points(kWidth, kHeight, points);
  TEST_ASSERT_FALSE(refine_pose(camera, points, good, 2, 1, &estimate));
  TEST_ASSERT_FALSE(refine_pose(camera, points, good, kPoseMaxPoints + 1, 1, &estimate));
  estimate.p_WC = Vec3(0, 0, 3);  // behind the wall, looking away
  TEST_ASSERT_FALSE(refine_pose(camera, points, good, 4, 1, &estimate));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_rectangle_pose_should_be_exact_when_the_corners_are);
  RUN_TEST(test_rectangle_pose_should_be_as_sure_as_it_says_when_the_corners_are_noisy);
  RUN_TEST(test_covariance_should_widen_when_the_mirrored_pose_fits_as_well);
  RUN_TEST(test_refined_pose_should_reach_the_truth_when_the_points_are_not_in_a_plane);
  RUN_TEST(test_pose_should_be_refused_when_the_input_makes_no_sense);
  return UNITY_END();
}
