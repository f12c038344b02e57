// The plane of a target's points: rectangles and coplanar points have one, three points and the corners of a step do not.
#include <cmath>

#include "geometry/so3.h"
#include "slam/target_surface.h"
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

void test_coplanar_points_have_the_normal_of_their_plane(void) {
  const Target target = rectangle(0);
  const Vec3 expected = target.q_WT * Vec3(0, 0, 1);
  TEST_ASSERT_TRUE(std::abs(target_normal(target).dot(expected)) > Scalar(1) - Scalar(1e-5));
}

void test_points_that_a_tape_measured_are_still_on_their_plane(void) {
  TEST_ASSERT_TRUE(std::abs(target_normal(rectangle(Scalar(0.002))).norm() - 1) < Scalar(1e-5));
}

void test_corners_of_a_step_have_no_plane(void) {
  TEST_ASSERT_TRUE(target_normal(rectangle(Scalar(0.1))).isZero(0));
}

void test_three_points_say_nothing_of_their_surface(void) {
  Target target = rectangle(0);
  target.count = 3;
  TEST_ASSERT_TRUE(target_normal(target).isZero(0));
}

void test_points_on_a_line_have_no_plane(void) {
  Target target = rectangle(0);
  for (int i = 0; i < 4; ++i) target.point_W[i] = Vec3(static_cast<Scalar>(i), 0, 1);
  TEST_ASSERT_TRUE(target_normal(target).isZero(0));
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_coplanar_points_have_the_normal_of_their_plane);
  RUN_TEST(test_points_that_a_tape_measured_are_still_on_their_plane);
  RUN_TEST(test_corners_of_a_step_have_no_plane);
  RUN_TEST(test_three_points_say_nothing_of_their_surface);
  RUN_TEST(test_points_on_a_line_have_no_plane);
  return UNITY_END();
}
