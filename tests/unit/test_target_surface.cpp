// The plane of a target's points: rectangles and coplanar points have one, three points and the corners of a step do not.
#include <cmath>

#include "frame/start/target_surface.h"
#include "geometry/so3.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

/// A rectangle 40 x 30 cm, turned and moved, whose third corner stands `out` of its plane.
Target rectangle(Scalar out) {
  Target target;
  target.kind = TargetKind::kPoints;
  target.count = 4;
  target.q_WT = exp_so3(Vec3(Scalar(0.3), Scalar(-0.5), Scalar(0.2)));
  const Vec3 centre(1, 2, 3);
  const Vec3 corner_T[4] = {{Scalar(-0.2), Scalar(-0.15), 0},
                            {Scalar(0.2), Scalar(-0.15), 0},
                            {Scalar(0.2), Scalar(0.15), out},
                            {Scalar(-0.2), Scalar(0.15), 0}};
  for (int i = 0; i < 4; ++i) target.point_W[i] = centre + target.q_WT * corner_T[i];
  target.first_pose.p_W = centre - target.q_WT * Vec3(0, 0, 1);
  return target;
}

}  // namespace

void test_target_normal_should_be_that_of_the_plane_when_points_are_coplanar(void) {
  const Target target = rectangle(0);
  const Vec3 expected = target.q_WT * Vec3(0, 0, 1);
  TEST_ASSERT_TRUE(std::abs(target_normal(target).dot(expected)) > Scalar(1) - Scalar(1e-5));
}

void test_target_normal_should_be_given_when_points_are_off_by_a_tape(void) {
  TEST_ASSERT_TRUE(std::abs(target_normal(rectangle(Scalar(0.002))).norm() - 1) < Scalar(1e-5));
}

void test_target_normal_should_be_zero_when_points_are_those_of_a_step(void) {
  TEST_ASSERT_TRUE(target_normal(rectangle(Scalar(0.1))).isZero(0));
}

void test_target_normal_should_be_zero_when_there_are_three_points(void) {
  Target target = rectangle(0);
  target.count = 3;
  TEST_ASSERT_TRUE(target_normal(target).isZero(0));
}

void test_target_normal_should_be_zero_when_points_are_on_a_line(void) {
  Target target = rectangle(0);
  for (int i = 0; i < 4; ++i) target.point_W[i] = Vec3(static_cast<Scalar>(i), 0, 1);
  TEST_ASSERT_TRUE(target_normal(target).isZero(0));
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_target_normal_should_be_that_of_the_plane_when_points_are_coplanar);
  RUN_TEST(test_target_normal_should_be_given_when_points_are_off_by_a_tape);
  RUN_TEST(test_target_normal_should_be_zero_when_points_are_those_of_a_step);
  RUN_TEST(test_target_normal_should_be_zero_when_there_are_three_points);
  RUN_TEST(test_target_normal_should_be_zero_when_points_are_on_a_line);
  return UNITY_END();
}
