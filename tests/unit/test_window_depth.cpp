// Depths of the window's points from the pixels of their keyframes and of a frame.
#include <cmath>

#include "keyframe_slam/map/depth.h"
#include "support/window_bench.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr double kTight = sizeof(Scalar) == 4 ? 1e-4 : 1e-9;

/// A frame beyond the last keyframe.
const CameraView kNow = {Quat::Identity(), Vec3(Scalar(0.8), 0, 0)};

Vec2 pixel_of(const KeyframeBench& bench, const Vec3& p_W) {
  Vec2 z;
  TEST_ASSERT_TRUE(project(bench.settings.camera, p_W - kNow.c_W, &z));
  return z;
}

void test_depth_should_be_that_of_exact_pixels() {
  KeyframeBench bench(1);
  const Vec3 p_W(Scalar(0.3), Scalar(-0.2), 2);
  const int i = bench.add(p_W, 0);
  DepthFit fit;
  TEST_ASSERT_TRUE(fit_depth(bench.settings.camera, bench.map, i, kNow, pixel_of(bench, p_W), &fit));
  // Pixels of keyframes are kept as single precision.
  TEST_ASSERT_TRUE(std::abs(fit.rho * p_W.norm() - 1) < 1e-5);
  TEST_ASSERT_TRUE(fit.worst_px < 1e-3);
  const double cosine = static_cast<double>(p_W.normalized().dot((p_W - kNow.c_W).normalized()));
  TEST_ASSERT_TRUE(std::abs(static_cast<double>(fit.cos_parallax) - cosine) < kTight);
}

void test_error_of_a_depth_should_be_as_its_information_says() {
  constexpr int kRuns = 200;
  constexpr double kSigma = 0.5;
  KeyframeBench bench(2);
  double nees = 0;
  for (int run = 0; run < kRuns; ++run) {
    const Vec3 p_W = Vec3(static_cast<Scalar>(bench.random.uniform(-0.3, 0.5)),
                          static_cast<Scalar>(bench.random.uniform(-0.4, 0.4)), 1) *
                     static_cast<Scalar>(bench.random.uniform(2, 4));
    const int i = bench.add(p_W, kSigma);
    DepthFit fit;
    const Vec2 pixel = pixel_of(bench, p_W) + bench.random.normals<2>(kSigma);
    TEST_ASSERT_TRUE(fit_depth(bench.settings.camera, bench.map, i, kNow, pixel, &fit));
    const double error = static_cast<double>(fit.rho - 1 / p_W.norm());
    nees += error * error * static_cast<double>(fit.information) / (kSigma * kSigma) / kRuns;
    bench.map.drop(i);
  }
  std::printf("NEES %.3f (1 expected)\n", nees);
  TEST_ASSERT_TRUE(nees > 0.7 && nees < 1.4);
}

void test_a_pixel_that_no_depth_explains_should_show_in_the_residual() {
  KeyframeBench bench(3);
  const Vec3 p_W(Scalar(0.3), 0, 2);
  const int i = bench.add(p_W, 0);
  DepthFit fit;
  TEST_ASSERT_TRUE(
      fit_depth(bench.settings.camera, bench.map, i, kNow, pixel_of(bench, p_W) + Vec2(0, Scalar(12)), &fit));
  TEST_ASSERT_TRUE(fit.worst_px > 10);
}

void test_rays_without_parallax_or_behind_should_give_no_depth() {
  KeyframeBench bench(4);
  const Vec3 p_W(Scalar(0.3), 0, 2);
  const int i = bench.add(p_W, 0);
  DepthFit fit;
  Vec2 same;
  TEST_ASSERT_TRUE(project(bench.settings.camera, p_W, &same));
  TEST_ASSERT_FALSE(fit_depth(bench.settings.camera, bench.map, i, {Quat::Identity(), Vec3::Zero()}, same, &fit));
  TEST_ASSERT_TRUE(fit.cos_parallax > 1 - 1e-5);
  // Farther to the right than the camera has moved to it: the rays meet behind.
  TEST_ASSERT_FALSE(fit_depth(bench.settings.camera, bench.map, i, kNow, same + Vec2(40, 0), &fit));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_depth_should_be_that_of_exact_pixels);
  RUN_TEST(test_error_of_a_depth_should_be_as_its_information_says);
  RUN_TEST(test_a_pixel_that_no_depth_explains_should_show_in_the_residual);
  RUN_TEST(test_rays_without_parallax_or_behind_should_give_no_depth);
  return UNITY_END();
}
