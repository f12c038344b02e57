// A pose that a camera holds, free or on a plane: where it is, and how it moves with the camera, the ray and the plane.
#include <cmath>

#include "geometry/held_pose.h"
#include "geometry/so3.h"
#include "support/numeric_jacobian.h"
#include "support/seeded_random.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

using Mat63 = HeldPose::Mat63;

RelativePlace random_place(SeededRandom* random, double size) {
  const Vec3 turn = random->normals<3>(1);
  const Vec3 at = random->normals<3>(size);
  return {exp_so3(turn), at};
}

RelativePlace moved(const RelativePlace& T, const Vec6& e) {
  return {(exp_so3(e.head<3>()) * T.q).normalized(), T.p + e.tail<3>()};
}

/// Error of a pose against another one.
Vec6 difference(const HeldPose& a, const HeldPose& from) {
  Vec6 e;
  e << log_so3((a.q_WA * from.q_WA.conjugate()).normalized()), a.p_WA - from.p_WA;
  return e;
}

/// A view of a plane and a pose that it holds on it.
struct Scene {
  RelativePlace T_WV, T_VA;
  PlaneFrame frame;
  Vec3 x;

  explicit Scene(SeededRandom* random) {
    frame.R_WP = exp_so3(random->normals<3>(2)).toRotationMatrix();
    frame.o_W = random->normals<3>(1);
    x = random->normals<3>(0.2);
    Vec3 n_W;
    Scalar d_W;
    plane_normal(frame, x, &n_W, &d_W);
    const Vec3 on = plane_point(frame, x, random->normals<2>(0.5));
    const Vec3 aside = random->normals<3>(0.4);
    T_WV.q = exp_so3(random->normals<3>(1));
    T_WV.p = on + Scalar(1.5) * n_W + aside - n_W * n_W.dot(aside);
    T_VA.p = T_WV.q.conjugate() * (on - T_WV.p);
    T_VA.q = upright_on(T_WV.q.conjugate() * n_W);
  }
};

void test_a_free_pose_should_follow_its_camera() {
  SeededRandom random(11);
  for (int trial = 0; trial < 30; ++trial) {
    const RelativePlace T_WV = random_place(&random, 1), T_VA = random_place(&random, 1);
    const HeldPose at = held_pose(T_WV, T_VA);
    check_jacobian<6, 6>(
        at.J_V, [&](const Vec6& e) { return difference(held_pose(moved(T_WV, e), T_VA), at); }, "J_V");
  }
}

void test_a_pose_on_a_plane_should_follow_camera_plane_and_ray() {
  SeededRandom random(12);
  for (int trial = 0; trial < 60; ++trial) {
    const Scene s(&random);
    HeldPose at;
    TEST_ASSERT_TRUE(held_pose_on(s.T_WV, s.T_VA, s.frame, s.x, &at));
    const auto on = [&](const RelativePlace& T_WV, const RelativePlace& T_VA, const Vec3& x) {
      HeldPose moved_pose;
      TEST_ASSERT_TRUE(held_pose_on(T_WV, T_VA, s.frame, x, &moved_pose));
      return difference(moved_pose, at);
    };
    check_jacobian<6, 6>(
        at.J_V, [&](const Vec6& e) { return on(moved(s.T_WV, e), s.T_VA, s.x); }, "J_V", Scalar(0.2));
    check_jacobian<6, 3>(
        at.J_plane, [&](const Vec3& e) { return on(s.T_WV, s.T_VA, s.x + e); }, "J_plane", Scalar(0.2));
    check_jacobian<3, 3>(
        at.J_ray,
        [&](const Vec3& e) {
          RelativePlace T_VA = s.T_VA;
          T_VA.p += s.T_WV.q.conjugate() * e;
          return Vec3(on(s.T_WV, T_VA, s.x).tail<3>());
        },
        "J_ray", Scalar(0.2));
  }
}

void test_a_pose_on_a_plane_should_lie_on_it_and_on_its_ray() {
  const Scalar rounding = kNumericJacobianIsFloat ? Scalar(1e-5) : Scalar(1e-12);
  SeededRandom random(13);
  for (int trial = 0; trial < 60; ++trial) {
    const Scene s(&random);
    const Vec3 x = s.x + random.normals<3>(0.05);  // the plane has moved since
    HeldPose at;
    TEST_ASSERT_TRUE(held_pose_on(s.T_WV, s.T_VA, s.frame, x, &at));
    Vec3 n_W;
    Scalar d_W;
    plane_normal(s.frame, x, &n_W, &d_W);
    TEST_ASSERT_TRUE(std::abs(n_W.dot(at.p_WA) - d_W) < rounding);
    TEST_ASSERT_TRUE((at.q_WA * Vec3::UnitZ() - n_W).norm() < rounding);
    const Vec3 along = s.T_WV.q * s.T_VA.p;
    TEST_ASSERT_TRUE(along.cross(at.p_WA - s.T_WV.p).norm() < rounding * along.squaredNorm() * 10);
    // Turned no further than the plane was.
    const Scalar turned = log_so3((at.q_WA * (s.T_WV.q * s.T_VA.q).conjugate()).normalized()).norm();
    const Scalar tilted = std::acos(std::min(Scalar(1), Scalar(n_W.dot(s.T_WV.q * (s.T_VA.q * Vec3::UnitZ())))));
    TEST_ASSERT_TRUE(std::abs(turned - tilted) < (kNumericJacobianIsFloat ? Scalar(2e-3) : Scalar(1e-7)));
  }
}

void test_a_plane_that_was_turned_round_should_keep_the_side_of_the_pose() {
  SeededRandom random(14);
  const Scene s(&random);
  PlaneFrame back = s.frame;
  back.R_WP.col(1) *= -1;
  back.R_WP.col(2) *= -1;
  HeldPose front, behind;
  TEST_ASSERT_TRUE(held_pose_on(s.T_WV, s.T_VA, s.frame, Vec3::Zero(), &front));
  TEST_ASSERT_TRUE(held_pose_on(s.T_WV, s.T_VA, back, Vec3::Zero(), &behind));
  TEST_ASSERT_TRUE(difference(front, behind).norm() < (kNumericJacobianIsFloat ? Scalar(1e-5) : Scalar(1e-12)));
}

void test_a_ray_that_misses_should_leave_everything_as_it_is() {
  SeededRandom random(15);
  Scene s(&random);
  HeldPose at;
  at.p_WA = Vec3(7, 7, 7);
  s.T_VA.p = -s.T_VA.p;
  TEST_ASSERT_FALSE(held_pose_on(s.T_WV, s.T_VA, s.frame, s.x, &at));
  s.T_VA.p.setZero();
  TEST_ASSERT_FALSE(held_pose_on(s.T_WV, s.T_VA, s.frame, s.x, &at));
  TEST_ASSERT_TRUE(at.p_WA == Vec3(7, 7, 7));
}

void test_upright_should_point_right_or_down() {
  const auto axes = [](const Vec3& n_V) { return upright_on(n_V.normalized()).toRotationMatrix(); };
  const Mat3 wall = axes(Vec3(0, 0, -1)), floor = axes(Vec3(0, -1, -1)), along = axes(Vec3(-1, 0, Scalar(-0.2)));
  TEST_ASSERT_TRUE((wall.col(0) - Vec3(1, 0, 0)).norm() < Scalar(1e-6));
  TEST_ASSERT_TRUE((wall.col(2) - Vec3(0, 0, -1)).norm() < Scalar(1e-6));
  TEST_ASSERT_TRUE((floor.col(0) - Vec3(1, 0, 0)).norm() < Scalar(1e-6));
  TEST_ASSERT_TRUE((along.col(0) - Vec3(0, 1, 0)).norm() < Scalar(1e-6));
  for (const Mat3& R : {wall, floor, along}) {
    TEST_ASSERT_TRUE((R.transpose() * R - Mat3::Identity()).norm() < Scalar(1e-5));
    TEST_ASSERT_TRUE(R.determinant() > 0);
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_a_free_pose_should_follow_its_camera);
  RUN_TEST(test_a_pose_on_a_plane_should_follow_camera_plane_and_ray);
  RUN_TEST(test_a_pose_on_a_plane_should_lie_on_it_and_on_its_ray);
  RUN_TEST(test_a_plane_that_was_turned_round_should_keep_the_side_of_the_pose);
  RUN_TEST(test_a_ray_that_misses_should_leave_everything_as_it_is);
  RUN_TEST(test_upright_should_point_right_or_down);
  return UNITY_END();
}
