// Planes in the adjustment of the window's keyframes: points are held to them, and they come back with their covariance.
#include <cmath>

#include "same.h"
#include "support/window_bench.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kOnPlane = 40;
constexpr double kSigma = 0.3;  // [px]

/// A slanted plane n . p = d in front of the keyframes.
const Vec3 kNormal = Vec3(Scalar(0.3), Scalar(-0.2), -1).normalized();
const Scalar kDistance = Scalar(-2.2);

Scalar height(const Vec3& p_W) { return kNormal.dot(p_W) - kDistance; }

Vec3 point_on_plane(KeyframeBench* bench) {
  const Scalar x = static_cast<Scalar>(bench->random.uniform(-0.3, 0.5));
  const Scalar y = static_cast<Scalar>(bench->random.uniform(-0.4, 0.4));
  const Vec3 ray(x, y, 1);
  return ray * (kDistance / kNormal.dot(ray));
}

/// Points on the plane, which is found among them.
void find_plane(KeyframeBench* bench) {
  for (int c = 0; c < kOnPlane; ++c) bench->place(bench->add(point_on_plane(bench), kSigma));
  for (int c = kOnPlane; c < KeyframeBench::kPoints; ++c) {
    const Vec3 p_W = point_on_plane(bench) * static_cast<Scalar>(bench->random.uniform(0.5, 0.8));
    bench->place(bench->add(p_W, kSigma));
  }
  bench->upkeep.maintain(Vec3::Zero());
  TEST_ASSERT_TRUE(bench->planes.used(0));
  TEST_ASSERT_TRUE(10 * bench->planes.points_on(0) >= 9 * kOnPlane);
}

double mean_square_height(const KeyframeBench& bench) {
  double sum = 0;
  for (int i = 0; i < kOnPlane; ++i) {
    const double e = static_cast<double>(height(bench.map.position(i)));
    sum += e * e / kOnPlane;
  }
  return sum;
}

void test_points_on_a_plane_should_be_held_to_it() {
  constexpr int kRuns = 20;
  double held = 0, loose = 0;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    KeyframeBench with(seed), without(seed);
    find_plane(&with);
    find_plane(&without);
    for (int i = 0; i < KeyframeBench::kPoints; ++i) without.map.point(i).plane = -1;
    TEST_ASSERT_TRUE(with.adjustment.run(false));
    TEST_ASSERT_TRUE(without.adjustment.run(false));
    TEST_ASSERT_TRUE(with.planes.plane(0).adjusted);
    TEST_ASSERT_FALSE(without.planes.plane(0).adjusted);
    held += mean_square_height(with) / kRuns;
    loose += mean_square_height(without) / kRuns;
  }
  std::printf("from the plane: %.2f mm, not held to it %.2f mm\n", std::sqrt(held) * 1e3, std::sqrt(loose) * 1e3);
  TEST_ASSERT_TRUE(std::sqrt(held) < 0.6 * std::sqrt(loose));
}

void test_error_of_an_adjusted_plane_should_be_as_its_covariance_says() {
  constexpr int kRuns = 30;
  double nees = 0;
  for (int run = 0; run < kRuns; ++run) {
    KeyframeBench bench(static_cast<std::uint64_t>(100 + run));
    find_plane(&bench);
    TEST_ASSERT_TRUE(bench.adjustment.run(false));
    const KeyframePlane& plane = bench.planes.plane(0);
    // The true plane about the frame that the adjusted one lies in.
    const Vec3 n = plane.frame.R_WP.transpose() * kNormal;
    const Vec3 x(-n.x() / n.z(), -n.y() / n.z(), -height(plane.frame.o_W) / n.z());
    const Eigen::Matrix3d P = plane.covariance.cast<double>();
    nees += x.cast<double>().dot(P.inverse() * x.cast<double>()) / (3 * kRuns);
  }
  std::printf("NEES per degree of freedom %.2f\n", nees);
  TEST_ASSERT_TRUE(nees > 0.1 && nees < 2);
}

void test_a_point_that_its_pixels_place_elsewhere_should_not_be_held() {
  KeyframeBench bench(2);
  find_plane(&bench);
  const int i = kOnPlane;
  const Vec3 before = bench.map.position(i);
  bench.map.point(i).plane = 0;
  TEST_ASSERT_TRUE(std::abs(height(before)) > Scalar(0.3));
  TEST_ASSERT_TRUE(bench.adjustment.run(false));
  TEST_ASSERT_TRUE((bench.map.position(i) - before).norm() < Scalar(0.05));
  bench.upkeep.maintain(Vec3::Zero());
  TEST_ASSERT_TRUE(bench.map.point(i).plane < 0);
}

void test_planes_should_not_be_adjusted_where_nothing_holds_the_scale() {
  KeyframeBench bench(3);
  find_plane(&bench);
  bench.settings.window_fixed = 1;
  TEST_ASSERT_TRUE(bench.adjustment.run(false));
  TEST_ASSERT_FALSE(bench.planes.plane(0).adjusted);
}

void test_a_plane_that_is_rotated_far_should_be_left_as_it_is() {
  KeyframeBench bench(4);
  find_plane(&bench);
  const PlaneFrame before = bench.planes.plane(0).frame;
  TEST_ASSERT_FALSE(bench.planes.take_adjusted(0, Vec3(1, 0, 0), Mat3::Identity()));
  TEST_ASSERT_SAME(bench.planes.plane(0).frame.o_W, before.o_W);
  TEST_ASSERT_FALSE(bench.planes.plane(0).adjusted);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_points_on_a_plane_should_be_held_to_it);
  RUN_TEST(test_error_of_an_adjusted_plane_should_be_as_its_covariance_says);
  RUN_TEST(test_a_point_that_its_pixels_place_elsewhere_should_not_be_held);
  RUN_TEST(test_planes_should_not_be_adjusted_where_nothing_holds_the_scale);
  RUN_TEST(test_a_plane_that_is_rotated_far_should_be_left_as_it_is);
  return UNITY_END();
}
