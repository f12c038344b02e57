// Every Jacobian of the paper's own filter in pf-sim, against central differences.
#include "base/eigen.h"
// The program's headers come after the library's door to Eigen, which sets it up.
#include <cmath>
#include <cstdio>

#include "../../tools/pf-sim/gee2007/inverse_depth.h"
#include "../../tools/pf-sim/gee2007/plane.h"
#include "../../tools/pf-sim/gee2007/plane_fit.h"
#include "support/seeded_random.h"
#include "unity.h"

using namespace pfsim::gee;

void setUp(void) {}
void tearDown(void) {}

namespace {

template <int N>
Mat<N, 1> draw(pf::SeededRandom& random, double sigma) {
  Mat<N, 1> v;
  for (int i = 0; i < N; ++i) v(i) = sigma * random.normal();
  return v;
}

/// f: Mat<N, 1> offset -> Mat<M, 1>, about zero; in double whatever the library's scalar is.
template <int M, int N, typename F>
void check(const Mat<M, N>& J, F f, const char* name) {
  Mat<M, N> numeric;
  for (int i = 0; i < N; ++i) {
    Mat<M, 1> slope[2];
    for (int k = 0; k < 2; ++k) {
      const double h = k == 0 ? 2e-4 : 1e-4;
      Mat<N, 1> e = Mat<N, 1>::Zero();
      e(i) = h;
      const Mat<M, 1> high = f(e), low = f(Mat<N, 1>(-e));
      slope[k] = (high - low) / (2 * h);
    }
    numeric.col(i) = (4 * slope[1] - slope[0]) / 3;
  }
  const double size = 1 + numeric.cwiseAbs().maxCoeff(), error = (J - numeric).cwiseAbs().maxCoeff();
  char text[120];
  std::snprintf(text, sizeof text, "%s differs by %.3g of %.3g", name, error, size);
  TEST_ASSERT_TRUE_MESSAGE(error < 1e-7 * size, text);
}

Vec7 random_pose(pf::SeededRandom& random) {
  Vec7 v;
  v << draw<4>(random, 1).normalized(), draw<3>(random, 1);
  return v;
}

/// A direction that keeps its distance from the pole.
Vec2 random_angles(pf::SeededRandom& random) { return {random.uniform(-3, 3), random.uniform(-1, 1)}; }

void test_quaternion_jacobians_should_be_exact() {
  pf::SeededRandom random(71);
  for (int trial = 0; trial < 30; ++trial) {
    const Vec4 q = random_pose(random).head<4>();
    const Vec3 v = draw<3>(random, 1);
    TEST_ASSERT_TRUE((rotate(q, v) - rotation_of(q) * v).norm() < 1e-12);
    TEST_ASSERT_TRUE((rotate_back(q, v) - rotation_of(q).transpose() * v).norm() < 1e-12);
    Mat<3, 4> J_q, J_back;
    rotate(q, v, &J_q);
    rotate_back(q, v, &J_back);
    check<3, 4>(
        J_q, [&](const Vec4& e) { return rotate(q + e, v); }, "rotate");
    check<3, 4>(
        J_back, [&](const Vec4& e) { return rotate_back(q + e, v); }, "rotate_back");
    check<4, 3>(
        increment_jacobian(q), [&](const Vec3& e) { return product(increment(e), q); }, "increment");
    const Vec4 longer = 1.3 * q;
    check<4, 4>(
        normalisation_jacobian(longer), [&](const Vec4& e) { return Vec4((longer + e).normalized()); },
        "normalisation");
    const Vec3 w = draw<3>(random, 1e-3);
    const Vec4 turned = -product(increment(w), q);  // the other sign is the same rotation
    TEST_ASSERT_TRUE((rotation_error(q, turned) - w).norm() < 1e-5);
  }
}

void test_projection_jacobians_should_be_exact() {
  pf::SeededRandom random(72);
  const Camera camera = Camera::with_field_of_view(43);
  for (int trial = 0; trial < 30; ++trial) {
    const Vec7 v = random_pose(random);
    const Vec3 in_camera(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(0.5, 3));
    const Vec3 m = rotation_of(v.head<4>()) * in_camera + v.tail<3>();
    Vec2 z;
    PointJacobians J;
    TEST_ASSERT_TRUE(project(camera, v, m, &z, &J));
    const auto at = [&](const Vec7& u, const Vec3& p) {
      Vec2 out;
      project(camera, u, p, &out);
      return out;
    };
    check<2, 3>(
        J.J_z_m, [&](const Vec3& e) { return at(v, m + e); }, "J_z_m");
    // Only changes of q that keep its length: along q the state has no uncertainty.
    const Mat<4, 3> tangent = increment_jacobian(v.head<4>());
    Mat<2, 6> J_pose;
    J_pose << J.J_z_v.leftCols<4>() * tangent, J.J_z_v.rightCols<3>();
    const auto moved = [&](const Vec6& e) {
      Vec7 u = v;
      u.head<4>() = product(increment(e.head<3>()), Vec4(v.head<4>()));
      u.tail<3>() += e.tail<3>();
      return at(u, m);
    };
    check<2, 6>(J_pose, moved, "J_z_v");
  }
  Vec2 z;
  TEST_ASSERT_FALSE(project(camera, random_pose(random), Vec3(std::nan(""), 0, 0), &z));
}

void test_inverse_depth_jacobians_should_be_exact() {
  pf::SeededRandom random(73);
  const Camera camera = Camera::with_field_of_view(43);
  for (int trial = 0; trial < 30; ++trial) {
    Vec6 f;
    f << draw<3>(random, 1), random_angles(random), random.uniform(0.3, 2);
    Mat<3, 6> J_m_f;
    inverse_depth_point(f, &J_m_f);
    check<3, 6>(
        J_m_f, [&](const Vec6& e) { return inverse_depth_point(f + e); }, "J_m_f");

    const Vec7 v = random_pose(random);
    const Vec2 pixel(random.uniform(0, 319), random.uniform(0, 239));
    BirthJacobians J, unused;
    const Vec6 born = begin_inverse_depth(camera, v, pixel, 0.7, &J);
    Vec2 again;
    TEST_ASSERT_TRUE(project(camera, v, inverse_depth_point(born), &again) && (again - pixel).norm() < 1e-9);
    if (std::abs(born(4)) > 1.2 || std::abs(born(3)) > 3) continue;  // the pole, and the seam of the angle
    const auto from_noise = [&](const Vec3& e) {
      return begin_inverse_depth(camera, v, pixel + e.head<2>(), 0.7 + e(2), &unused);
    };
    check<6, 3>(J.J_f_n, from_noise, "J_f_n");
    const Mat<4, 3> tangent = increment_jacobian(v.head<4>());
    Mat<6, 6> J_pose;
    J_pose << J.J_f_v.leftCols<4>() * tangent, J.J_f_v.rightCols<3>();
    const auto from_pose = [&](const Vec6& e) {
      Vec7 u = v;
      u.head<4>() = product(increment(e.head<3>()), Vec4(v.head<4>()));
      u.tail<3>() += e.tail<3>();
      return begin_inverse_depth(camera, u, pixel, 0.7, &unused);
    };
    check<6, 6>(J_pose, from_pose, "J_f_v");
  }
}

void test_plane_jacobians_should_be_exact() {
  pf::SeededRandom random(74);
  for (int trial = 0; trial < 30; ++trial) {
    Vec7 s;
    s << draw<3>(random, 1), random_angles(random), random_angles(random);
    const Vec3 m = draw<3>(random, 1);
    const Vec2 u = draw<2>(random, 1);
    Mat<3, 2> J_c;
    direction(s(3), s(4), &J_c);
    check<3, 2>(
        J_c, [&](const Vec2& e) { return direction(s(3) + e(0), s(4) + e(1)); }, "direction");
    const Vec3 g = 1.7 * direction(s(3), s(4));
    Mat<2, 3> J_angles;
    TEST_ASSERT_TRUE((angles_of(g, &J_angles) - s.segment<2>(3)).norm() < 1e-12);
    check<2, 3>(
        J_angles, [&](const Vec3& e) { return angles_of(g + e); }, "angles_of");
    FoldJacobians J;
    fold_point(s, m, &J);
    check<2, 7>(
        J.J_u_s, [&](const Vec7& e) { return fold_point(s + e, m); }, "J_u_s");
    check<2, 3>(
        J.J_u_m, [&](const Vec3& e) { return fold_point(s, m + e); }, "J_u_m");
    UnfoldJacobians back;
    unfold_point(s, u, &back);
    check<3, 7>(
        back.J_m_s, [&](const Vec7& e) { return unfold_point(s + e, u); }, "J_m_s");
    check<3, 2>(
        back.J_m_u, [&](const Vec2& e) { return unfold_point(s, u + e); }, "J_m_u");
  }
}

void test_plane_fit_jacobian_should_be_exact_when_points_lie_off_the_plane() {
  pf::SeededRandom random(75);
  for (int trial = 0; trial < 20; ++trial) {
    const Mat3 R = rotation_of(random_pose(random).head<4>());
    std::vector<Vec3> points;
    for (int i = 0; i < 9; ++i)
      points.push_back(R * Vec3(1.5 * random.normal(), 0.7 * random.normal(), 0.05 * random.normal()));
    PlaneFit fit;
    TEST_ASSERT_TRUE(fit_plane(points, &fit));
    const Vec3 c1 = direction(fit.plane(3), fit.plane(4)), c2 = direction(fit.plane(5), fit.plane(6));
    if (std::abs(c1.y()) > 0.9 || std::abs(c2.y()) > 0.9) continue;
    TEST_ASSERT_TRUE(std::abs(c1.dot(c2)) < 1e-12 && (c1.cross(c2) - fit.normal).norm() < 1e-12);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto moved = [&](const Vec3& e) {
        std::vector<Vec3> other = points;
        other[i] += e;
        PlaneFit out;
        fit_plane(other, &out);
        // An eigenvector has two signs: the one nearer to that of the unmoved points.
        for (int b = 3; b < 7; b += 2) {
          Vec3 c = direction(out.plane(b), out.plane(b + 1));
          if (c.dot(b == 3 ? c1 : c2) < 0) out.plane.segment<2>(b) = angles_of(-c);
          const double turns = std::round((fit.plane(b) - out.plane(b)) / 6.283185307179586);
          out.plane(b) += turns * 6.283185307179586;
        }
        return out.plane;
      };
      check<7, 3>(fit.J[i], moved, "plane fit");
    }
  }
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_quaternion_jacobians_should_be_exact);
  RUN_TEST(test_projection_jacobians_should_be_exact);
  RUN_TEST(test_inverse_depth_jacobians_should_be_exact);
  RUN_TEST(test_plane_jacobians_should_be_exact);
  RUN_TEST(test_plane_fit_jacobian_should_be_exact_when_points_lie_off_the_plane);
  return UNITY_END();
}
