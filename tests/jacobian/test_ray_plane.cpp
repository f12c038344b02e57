// A ray meets a plane: where, how the hit moves, and when there is none.
#include <cmath>

#include "geometry/ray_plane.h"
#include "geometry/so3.h"
#include "same.h"
#include "support/numeric_jacobian.h"
#include "support/seeded_random.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

PlaneFrame random_frame(SeededRandom& random) {
  PlaneFrame frame;
  frame.R_WP = exp_so3(random.normals<3>(2)).toRotationMatrix();
  frame.o_W = random.normals<3>(1);
  return frame;
}

void test_hit_jacobians_should_be_exact_when_the_ray_is_slanted() {
  SeededRandom random(41);
  int met = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const PlaneFrame frame = random_frame(random);
    const Vec3 x = random.normals<3>(0.3);
    const Vec2 uv = random.normals<2>(0.5);
    const Vec3 on = plane_point(frame, x, uv);
    Vec3 n;
    Scalar d;
    plane_normal(frame, x, &n, &d);
    // From either side, not flatter than about 60 degrees, with a direction that is not of unit length.
    const Vec3 aside = random.normals<3>(0.4);
    const Vec3 origin = on + (trial % 2 == 0 ? n : Vec3(-n)) * Scalar(1.5) + aside - n * n.dot(aside);
    const Vec3 direction = (on - origin) * Scalar(random.uniform(0.3, 2));
    Vec3 hit;
    Mat3 J_o, J_d, J_x;
    TEST_ASSERT_TRUE(intersect_ray_plane(frame, x, origin, direction, &hit, &J_o, &J_d, &J_x));
    ++met;
    TEST_ASSERT_TRUE((hit - on).norm() < (kNumericJacobianIsFloat ? Scalar(1e-5) : Scalar(1e-13)));
    const auto at = [&](const Vec3& o, const Vec3& r, const Vec3& y) {
      Vec3 p = Vec3::Zero();
      TEST_ASSERT_TRUE(intersect_ray_plane(frame, y, o, r, &p));
      return p;
    };
    check_jacobian<3, 3>(
        J_o, [&](const Vec3& e) { return at(origin + e, direction, x); }, "J_hit_origin", Scalar(0.5));
    check_jacobian<3, 3>(
        J_d, [&](const Vec3& e) { return at(origin, direction + e, x); }, "J_hit_direction", Scalar(0.2));
    check_jacobian<3, 3>(
        J_x, [&](const Vec3& e) { return at(origin, direction, x + e); }, "J_hit_x", Scalar(0.2));
  }
  TEST_ASSERT_EQUAL_INT(60, met);
}

void test_hit_should_be_refused_when_the_plane_is_behind() {
  const PlaneFrame frame;
  Vec3 hit(7, 7, 7);
  TEST_ASSERT_FALSE(intersect_ray_plane(frame, Vec3::Zero(), Vec3(0, 0, 1), Vec3(0, 0, 1), &hit));
  TEST_ASSERT_FALSE(intersect_ray_plane(frame, Vec3::Zero(), Vec3(0, 0, -1), Vec3(0, 0, -1), &hit));
  TEST_ASSERT_SAME(Vec3(7, 7, 7), hit);
  TEST_ASSERT_TRUE(intersect_ray_plane(frame, Vec3::Zero(), Vec3(0, 0, -1), Vec3(0, 0, 1), &hit));
  TEST_ASSERT_TRUE(hit.norm() < Scalar(1e-6));
}

void test_hit_should_be_refused_when_the_ray_grazes() {
  const PlaneFrame frame;
  Vec3 hit;
  const auto met = [&](double degrees) {
    const double angle = degrees * 3.14159265358979 / 180;
    const Vec3 direction(static_cast<Scalar>(std::sin(angle)), 0, static_cast<Scalar>(-std::cos(angle)));
    return intersect_ray_plane(frame, Vec3::Zero(), Vec3(0, 0, 1), direction, &hit);
  };
  TEST_ASSERT_TRUE(met(84));
  TEST_ASSERT_FALSE(met(86));
  TEST_ASSERT_FALSE(met(90));
}

void test_hit_should_be_refused_when_the_ray_is_nothing() {
  const PlaneFrame frame;
  Vec3 hit;
  const Scalar nan = std::sqrt(Scalar(-1));
  TEST_ASSERT_FALSE(intersect_ray_plane(frame, Vec3::Zero(), Vec3(0, 0, 1), Vec3::Zero(), &hit));
  TEST_ASSERT_FALSE(intersect_ray_plane(frame, Vec3::Zero(), Vec3(0, 0, 1), Vec3(0, nan, -1), &hit));
  TEST_ASSERT_FALSE(intersect_ray_plane(frame, Vec3::Zero(), Vec3(0, nan, 1), Vec3(0, 0, -1), &hit));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_hit_jacobians_should_be_exact_when_the_ray_is_slanted);
  RUN_TEST(test_hit_should_be_refused_when_the_plane_is_behind);
  RUN_TEST(test_hit_should_be_refused_when_the_ray_grazes);
  RUN_TEST(test_hit_should_be_refused_when_the_ray_is_nothing);
  return UNITY_END();
}
