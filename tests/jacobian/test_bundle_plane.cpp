// The distance of a bundle's point from a plane: Jacobians by plane, host and inverse depth, in double and in float.
#include "bundle/bearing.h"
#include "geometry/so3.h"
#include "support/numeric_jacobian.h"
#include "support/seeded_random.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

/// Compares the derivatives by plane, host and inverse depth with differences. distance(x, h, e) moves them by as much.
template <typename Distance>
void check_by_differences(const Distance& distance, const Mat13& J_plane, const Mat16& J_H,
                          const Eigen::Matrix<Scalar, 1, 1>& J_rho) {
  check_jacobian<1, 3>(
      J_plane, [&](const Vec3& x) { return distance(x, Vec6::Zero(), 0); }, "J_e_plane");
  check_jacobian<1, 6>(
      J_H, [&](const Vec6& h) { return distance(Vec3::Zero(), h, 0); }, "J_e_H");
  check_jacobian<1, 1>(
      J_rho, [&](const Eigen::Matrix<Scalar, 1, 1>& s) { return distance(Vec3::Zero(), Vec6::Zero(), s(0)); },
      "J_e_rho", Scalar(0.3));
}

void test_bundle_plane_jacobians_should_be_exact() {
  SeededRandom random(42);
  using Vec1 = Eigen::Matrix<Scalar, 1, 1>;
  for (int trial = 0; trial < 40; ++trial) {
    BundlePlane plane = {
        {exp_so3(random.normals<3>(1)).toRotationMatrix(), random.normals<3>(1)}, random.normals<3>(0.2), 1, true};
    const Mat3 R_WH = exp_so3(random.normals<3>(1)).toRotationMatrix();
    const Vec3 p_H = random.normals<3>(1);
    Vec3 ray(0, 0, 1);
    ray.head<2>() = random.normals<2>(0.3);
    const Scalar rho = static_cast<Scalar>(random.uniform(0.5, 2));
    const auto distance = [&](const Vec3& x, const Vec6& h, Scalar e) {
      BundlePlane moved = plane;
      moved.x += x;
      const Mat3 R_H = exp_so3(h.head<3>()).toRotationMatrix().lazyProduct(R_WH);
      return Vec1(bearing_plane_distance(moved, R_H.lazyProduct(ray), p_H + h.tail<3>(), rho + e));
    };
    Mat13 J_plane;
    Mat16 J_H;
    Vec1 J_rho;
    const Scalar e = bearing_plane_distance(plane, R_WH.lazyProduct(ray), p_H, rho, &J_plane, &J_H, &J_rho(0));
    Vec3 n;
    Scalar d;
    plane_normal(plane.frame, plane.x, &n, &d);
    TEST_ASSERT_TRUE(std::abs(e - (n.dot(p_H + R_WH * ray / rho) - d)) < Scalar(1e-5));
    check_by_differences(distance, J_plane, J_H, J_rho);
  }
}

void test_relative_plane_distance_should_have_exact_jacobians() {
  SeededRandom random(43);
  using Vec1 = Eigen::Matrix<Scalar, 1, 1>;
  for (int trial = 0; trial < 40; ++trial) {
    BundlePlane plane = {
        {exp_so3(random.normals<3>(1)).toRotationMatrix(), random.normals<3>(1)}, random.normals<3>(0.2), 1, true};
    const Vec3 p_H = random.normals<3>(1);
    Vec3 ray = random.normals<3>(0.3);
    ray.z() = 1;
    const Scalar rho = static_cast<Scalar>(random.uniform(0.5, 2));
    const Scalar before = rho * static_cast<Scalar>(random.uniform(0.8, 1.2));
    const auto distance = [&](const Vec3& x, const Vec6& h, Scalar e) {
      BundlePlane moved = plane;
      moved.x += x;
      const Mat3 R = exp_so3(h.head<3>()).toRotationMatrix();
      return Vec1(relative_plane_distance(moved, R.lazyProduct(ray), p_H + h.tail<3>(), rho + e, before));
    };
    Mat13 J_plane;
    Mat16 J_H;
    Vec1 J_rho;
    const Scalar e = relative_plane_distance(plane, ray, p_H, rho, before, &J_plane, &J_H, &J_rho(0));
    TEST_ASSERT_TRUE(std::abs(e - rho / before * bearing_plane_distance(plane, ray, p_H, rho)) < Scalar(1e-5));
    check_by_differences(distance, J_plane, J_H, J_rho);
  }
}

void test_relative_plane_distance_should_not_change_with_the_size_of_the_map() {
  SeededRandom random(44);
  for (int trial = 0; trial < 40; ++trial) {
    const BundlePlane plane = {
        {exp_so3(random.normals<3>(1)).toRotationMatrix(), random.normals<3>(1)}, random.normals<3>(0.2), 1, true};
    const Vec3 p_H = random.normals<3>(1), ray(Scalar(0.1), Scalar(-0.2), 1);
    const Scalar rho = static_cast<Scalar>(random.uniform(0.5, 2)), s = static_cast<Scalar>(random.uniform(0.5, 2));
    BundlePlane scaled = plane;
    scaled.frame.o_W *= s;
    scaled.x.z() *= s;
    const Scalar e = relative_plane_distance(plane, ray, p_H, rho, rho);
    TEST_ASSERT_TRUE(std::abs(e - relative_plane_distance(scaled, ray, s * p_H, rho / s, rho)) < Scalar(1e-5));
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_bundle_plane_jacobians_should_be_exact);
  RUN_TEST(test_relative_plane_distance_should_have_exact_jacobians);
  RUN_TEST(test_relative_plane_distance_should_not_change_with_the_size_of_the_map);
  return UNITY_END();
}
