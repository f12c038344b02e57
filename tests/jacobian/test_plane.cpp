// Every Jacobian of a plane about its constant frame, and of the fit, in double and in float.
#include <cmath>

#include "geometry/plane.h"
#include "geometry/so3.h"
#include "geometry/symmetric_eigen.h"
#include "support/numeric_jacobian.h"
#include "support/seeded_random.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

using Vec7 = Eigen::Matrix<Scalar, 7, 1>;
using Vec1 = Eigen::Matrix<Scalar, 1, 1>;

PlaneFrame random_frame(SeededRandom& random) {
  PlaneFrame frame;
  frame.R_WP = exp_so3(random.normals<3>(2)).toRotationMatrix();
  frame.o_W = random.normals<3>(1);
  return frame;
}

void test_plane_jacobians_should_be_exact_when_slanted_against_the_frame() {
  SeededRandom random(31);
  for (int trial = 0; trial < 50; ++trial) {
    const PlaneFrame frame = random_frame(random);
    const Vec3 x = random.normals<3>(0.3), p = random.normals<3>(1);
    const Vec2 uv = random.normals<2>(1);
    Mat3 J_p_x, J_n_x;
    Mat32 J_p_uv;
    Mat13 J_d_x, J_r_x, J_r_p;
    Vec3 n;
    Scalar d;
    const Vec3 on = plane_point(frame, x, uv, &J_p_x, &J_p_uv);
    plane_normal(frame, x, &n, &d, &J_n_x, &J_d_x);
    const Scalar r = plane_distance(frame, x, p, &J_r_x, &J_r_p);
    const Scalar tolerance = kNumericJacobianIsFloat ? Scalar(1e-5) : Scalar(1e-13);
    TEST_ASSERT_TRUE(std::abs(n.dot(on) - d) < tolerance && std::abs(n.dot(p) - d - r) < tolerance);
    TEST_ASSERT_TRUE((plane_coordinates(frame, on) - uv).norm() < tolerance);

    check_jacobian<3, 3>(
        J_p_x, [&](const Vec3& e) { return plane_point(frame, x + e, uv); }, "J_p_x");
    check_jacobian<3, 2>(
        J_p_uv, [&](const Vec2& e) { return plane_point(frame, x, uv + e); }, "J_p_uv");
    const auto normal = [&](const Vec3& e) {
      Vec3 m;
      Scalar k;
      plane_normal(frame, x + e, &m, &k);
      return m;
    };
    check_jacobian<3, 3>(J_n_x, normal, "J_n_x");
    const auto distance = [&](const Vec3& e) {
      Vec3 m;
      Scalar k;
      plane_normal(frame, x + e, &m, &k);
      return Vec1(k);
    };
    check_jacobian<1, 3>(J_d_x, distance, "J_d_x");
    check_jacobian<1, 3>(
        J_r_x, [&](const Vec3& e) { return Vec1(plane_distance(frame, x + e, p)); }, "J_r_x");
    check_jacobian<1, 3>(
        J_r_p, [&](const Vec3& e) { return Vec1(plane_distance(frame, x, p + e)); }, "J_r_p");
  }
}

void test_plane_gauge_should_move_the_plane_with_its_points_when_the_world_moves() {
  SeededRandom random(32);
  for (int trial = 0; trial < 50; ++trial) {
    const PlaneFrame frame = random_frame(random);
    const Vec3 x = random.normals<3>(0.3);
    // The plane through three moved points, about the same frame.
    const auto moved = [&](const Vec7& e) {
      const Mat3 R = exp_so3(e.segment<3>(3)).toRotationMatrix();
      const Scalar scale = std::exp(e(6));
      Vec3 p[3];
      const Vec2 uv[3] = {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
      for (int i = 0; i < 3; ++i) p[i] = scale * (R * plane_point(frame, x, uv[i])) + e.head<3>();
      PlaneFrame there;
      there.o_W = p[0];
      there.R_WP.col(2) = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
      there.R_WP.col(0) = (p[1] - p[0]).normalized();
      there.R_WP.col(1) = there.R_WP.col(2).cross(there.R_WP.col(0));
      Vec3 out;
      TEST_ASSERT_TRUE(reframe_plane(there, Vec3::Zero(), frame, &out));
      return out;
    };
    check_jacobian<3, 7>(plane_gauge(frame, x), moved, "plane_gauge", Scalar(0.5));
  }
}

void test_reframed_plane_should_be_the_same_plane_when_the_frame_is_another() {
  SeededRandom random(33);
  for (int trial = 0; trial < 50; ++trial) {
    const PlaneFrame from = random_frame(random);
    PlaneFrame to = from;
    to.R_WP = exp_so3(random.normals<3>(0.3)).toRotationMatrix() * from.R_WP;
    to.o_W += random.normals<3>(0.3);
    const Vec3 x = random.normals<3>(0.2);
    Vec3 y;
    Mat3 J;
    if (!reframe_plane(from, x, to, &y, &J)) continue;
    const Vec3 p = plane_point(from, x, random.normals<2>(1));
    TEST_ASSERT_TRUE(std::abs(plane_distance(to, y, p)) < (kNumericJacobianIsFloat ? Scalar(1e-5) : Scalar(1e-13)));
    const auto f = [&](const Vec3& e) {
      Vec3 z;
      TEST_ASSERT_TRUE(reframe_plane(from, x + e, to, &z));
      return z;
    };
    check_jacobian<3, 3>(J, f, "J_new_old", Scalar(0.2));
  }
  PlaneFrame side;
  side.R_WP << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  Vec3 y;
  TEST_ASSERT_FALSE(reframe_plane(PlaneFrame(), Vec3::Zero(), side, &y));
}

void test_fit_jacobian_should_be_exact_when_points_lie_near_a_plane() {
  SeededRandom random(34);
  for (int trial = 0; trial < 30; ++trial) {
    constexpr int kCount = 9;
    const PlaneFrame frame = random_frame(random);
    Vec3 points[kCount];
    for (Vec3& p : points) {
      const Vec2 uv(static_cast<Scalar>(1.5 * random.normal()), static_cast<Scalar>(random.normal()));
      p = plane_point(frame, Vec3(0, 0, static_cast<Scalar>(0.05 * random.normal())), uv);
    }
    const Vec3 viewer = frame.o_W + frame.R_WP * Vec3(0, 0, 5);
    PlaneFit fit;
    TEST_ASSERT_TRUE(fit_plane(points, kCount, viewer, &fit));
    TEST_ASSERT_TRUE(fit.frame.R_WP.col(2).dot(frame.R_WP.col(2)) > Scalar(0.9));
    TEST_ASSERT_TRUE(std::abs(fit.frame.R_WP.determinant() - 1) < Scalar(1e-5));
    for (int i = 0; i < kCount; ++i) {
      const auto f = [&](const Vec3& e) {
        Vec3 changed[kCount];
        for (int k = 0; k < kCount; ++k) changed[k] = k == i ? Vec3(points[k] + e) : points[k];
        PlaneFit other;
        Vec3 x;
        TEST_ASSERT_TRUE(fit_plane(changed, kCount, viewer, &other));
        TEST_ASSERT_TRUE(reframe_plane(other.frame, Vec3::Zero(), fit.frame, &x));
        return x;
      };
      check_jacobian<3, 3>(fit_plane_jacobian(fit, points[i]), f, "J_x_p");
    }
  }
}

void test_fit_should_be_refused_when_points_are_few_or_in_line() {
  Vec3 points[5];
  PlaneFit fit;
  for (int i = 0; i < 5; ++i) points[i] = Vec3(static_cast<Scalar>(i), static_cast<Scalar>(2 * i), 1);
  TEST_ASSERT_FALSE(fit_plane(points, 5, Vec3::Zero(), &fit));
  TEST_ASSERT_FALSE(fit_plane(points, 2, Vec3::Zero(), &fit));
  points[2].z() += 1;
  TEST_ASSERT_TRUE(fit_plane(points, 5, Vec3::Zero(), &fit));
  points[2].z() = std::sqrt(Scalar(-1));
  TEST_ASSERT_FALSE(fit_plane(points, 5, Vec3::Zero(), &fit));
}

void test_eigenvectors_should_rebuild_the_matrix_when_it_is_symmetric() {
  SeededRandom random(35);
  for (int trial = 0; trial < 100; ++trial) {
    Mat3 B;
    for (int i = 0; i < 3; ++i) B.col(i) = random.normals<3>(1);
    if (trial % 5 == 0) B.col(1) = B.col(0);
    if (trial % 7 == 0) B.setIdentity();
    const Mat3 A = B * B.transpose();
    Vec3 lambda;
    Mat3 V;
    symmetric_eigen(A, &lambda, &V);
    const Scalar tolerance = (kNumericJacobianIsFloat ? Scalar(1e-5) : Scalar(1e-13)) * (1 + A.norm());
    TEST_ASSERT_TRUE((V * lambda.asDiagonal() * V.transpose() - A).norm() < tolerance);
    TEST_ASSERT_TRUE(lambda(0) <= lambda(1) && lambda(1) <= lambda(2));
    TEST_ASSERT_TRUE(std::abs(V.determinant() - 1) < Scalar(1e-5));
  }
}

/// A wall's prior is stated at its own centre, in rotations of the normal and the distance there; the state has (a, b, h). The numbers of a
/// plane that is off by e, by its points.
void test_a_wall_s_prior_should_become_that_of_the_plane_s_block() {
  SeededRandom random(37);
  for (int trial = 0; trial < 20; ++trial) {
    const PlaneFrame frame = random_frame(random);
    const auto block_of = [&](const Vec3& e) {
      const Mat3& R = frame.R_WP;
      const Vec3 n = (R.col(2) + e(0) * R.col(0) + e(1) * R.col(1)).normalized();
      // p = o + R (u, v, z) with n' . (p - o) = delta
      const auto height = [&](Scalar u, Scalar v) {
        return (e(2) - n.dot(u * R.col(0) + v * R.col(1))) / n.dot(R.col(2));
      };
      const Scalar h = height(0, 0);
      return Vec3(height(1, 0) - h, height(0, 1) - h, h);
    };
    check_jacobian<3, 3>(plane_error_jacobian(), block_of, "J_x_e");
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_plane_jacobians_should_be_exact_when_slanted_against_the_frame);
  RUN_TEST(test_plane_gauge_should_move_the_plane_with_its_points_when_the_world_moves);
  RUN_TEST(test_reframed_plane_should_be_the_same_plane_when_the_frame_is_another);
  RUN_TEST(test_fit_jacobian_should_be_exact_when_points_lie_near_a_plane);
  RUN_TEST(test_fit_should_be_refused_when_points_are_few_or_in_line);
  RUN_TEST(test_a_wall_s_prior_should_become_that_of_the_plane_s_block);
  RUN_TEST(test_eigenvectors_should_rebuild_the_matrix_when_it_is_symmetric);
  return UNITY_END();
}
