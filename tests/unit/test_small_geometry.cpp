// Small Cholesky factor, four-point homography, and the turn of the z axis.
#include <cmath>

#include "geometry/homography.h"
#include "geometry/small_cholesky.h"
#include "geometry/so3.h"
#include "same.h"
#include "support/seeded_random.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr bool kFloat = sizeof(Scalar) == 4;

void test_cholesky_should_solve_when_rows_have_very_different_units() {
  SeededRandom random(5);
  for (int trial = 0; trial < 50; ++trial) {
    Mat6 B, D = Mat6::Zero();
    for (int i = 0; i < 6; ++i) {
      B.col(i) = random.normals<6>(1);
      D(i, i) = static_cast<Scalar>(std::pow(10.0, random.uniform(-4, 4)));
    }
    const Mat6 A = D * Mat6(B * B.transpose() + Mat6::Identity()) * D;
    SmallCholesky<6> factored;
    TEST_ASSERT_TRUE(factored.factor(A));
    const Vec6 x = D.inverse() * random.normals<6>(1), b = A * x;
    const Vec6 error = D * (factored.solve<1>(b) - x);
    TEST_ASSERT_TRUE(error.norm() < (kFloat ? Scalar(1e-3) : Scalar(1e-12)));
    const Mat6 left = D * Mat6(factored.inverse() * A) * D.inverse();
    TEST_ASSERT_TRUE((left - Mat6::Identity()).norm() < (kFloat ? Scalar(1e-2) : Scalar(1e-11)));
  }
}

void test_cholesky_should_refuse_when_the_matrix_is_singular_or_not_finite() {
  SmallCholesky<3> factored;
  Mat3 A = Mat3::Ones();
  TEST_ASSERT_FALSE(factored.factor(A));
  A = -Mat3::Identity();
  TEST_ASSERT_FALSE(factored.factor(A));
  A = Mat3::Identity() / Scalar(0);
  TEST_ASSERT_FALSE(factored.factor(A));
  A = Mat3::Identity() * std::sqrt(Scalar(-1));
  TEST_ASSERT_FALSE(factored.factor(A));
  A = Mat3::Identity();
  A(2, 0) = std::sqrt(Scalar(-1));
  TEST_ASSERT_FALSE(factored.factor(A));
}

void test_homography_should_map_the_points_when_they_are_rays_of_any_side() {
  SeededRandom random(6);
  int made = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Mat3 truth;
    for (int i = 0; i < 3; ++i) truth.col(i) = random.normals<3>(1);
    Vec3 from[4], to[4];
    for (int i = 0; i < 4; ++i) {
      from[i] = random.normals<3>(1);
      to[i] = truth * from[i] * static_cast<Scalar>(random.uniform(0.1, 10));
    }
    Mat3 H;
    TEST_ASSERT_TRUE(homography_from_4(from, to, &H));
    const Mat3 expected = truth / truth.norm();
    if ((H - expected).norm() < (kFloat ? Scalar(1e-2) : Scalar(1e-9))) ++made;
  }
  TEST_ASSERT_GREATER_OR_EQUAL_INT(kFloat ? 190 : 199, made);
}

void test_homography_should_refuse_when_points_are_in_line_or_change_side() {
  const Vec3 square[4] = {Vec3(0, 0, 1), Vec3(1, 0, 1), Vec3(1, 1, 1), Vec3(0, 1, 1)};
  const Vec3 line[4] = {Vec3(0, 0, 1), Vec3(1, 0, 1), Vec3(2, 0, 1), Vec3(0, 1, 1)};
  const Vec3 line_late[4] = {Vec3(0, 0, 1), Vec3(1, 0, 1), Vec3(1, 1, 1), Vec3(2, 0, 1)};
  const Vec3 behind[4] = {Vec3(0, 0, 1), Vec3(1, 0, 1), Vec3(-1, -1, -1), Vec3(0, 1, 1)};
  Mat3 H = Mat3::Zero();
  TEST_ASSERT_FALSE(homography_from_4(line, square, &H));
  TEST_ASSERT_FALSE(homography_from_4(square, line, &H));
  TEST_ASSERT_FALSE(homography_from_4(square, line_late, &H));
  TEST_ASSERT_FALSE(homography_from_4(square, behind, &H));
  TEST_ASSERT_SAME(Mat3::Zero(), H);
  TEST_ASSERT_TRUE(homography_from_4(square, square, &H));
}

void test_turn_should_take_z_to_the_vector_the_shortest_way_when_it_is_of_unit_length() {
  SeededRandom random(7);
  constexpr Scalar kClose = kFloat ? Scalar(2e-6) : Scalar(1e-14);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 b = random.normals<3>(1).normalized();
    const Quat q = turn_z_to(b);
    TEST_ASSERT_TRUE((q.toRotationMatrix().col(2) - b).norm() < kClose / (Scalar(1) + b.z()));
    TEST_ASSERT_SAME(Scalar(0), q.z());
    TEST_ASSERT_TRUE(q.w() >= Scalar(0));  // no turn about z or about b
  }
  TEST_ASSERT_SAME(Mat3::Identity(), turn_z_to(Vec3::UnitZ()).toRotationMatrix());
  TEST_ASSERT_TRUE((turn_z_to(-Vec3::UnitZ()).toRotationMatrix().col(2) + Vec3::UnitZ()).norm() < kClose);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_cholesky_should_solve_when_rows_have_very_different_units);
  RUN_TEST(test_cholesky_should_refuse_when_the_matrix_is_singular_or_not_finite);
  RUN_TEST(test_homography_should_map_the_points_when_they_are_rays_of_any_side);
  RUN_TEST(test_homography_should_refuse_when_points_are_in_line_or_change_side);
  RUN_TEST(test_turn_should_take_z_to_the_vector_the_shortest_way_when_it_is_of_unit_length);
  return UNITY_END();
}
