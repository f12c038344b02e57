// The homography of a template's surface: its derivative by the slopes is what the aligner's warp says, and it is R + t n^T / d.
#include "support/numeric_jacobian.h"
#include "support/seeded_random.h"
#include "track/template_warp.h"
#include "vision/plane_warps.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

TemplateWarp random_warp(SeededRandom& random) {
  TemplateWarp warp;
  const Vec3 w = random.normals<3>(0.1);
  warp.R_CK = Quat(1, w.x() / 2, w.y() / 2, w.z() / 2).normalized().toRotationMatrix();
  warp.t = random.normals<3>(0.15);
  warp.ray_0 = random.normals<2>(0.3);
  return warp;
}

void test_slopes_should_move_pixels_as_the_aligner_says() {
  SeededRandom random(641);
  for (int trial = 0; trial < 20; ++trial) {
    const TemplateWarp warp = random_warp(random);
    const Vec2 slope = random.normals<2>(0.3);
    const Vec2 off = random.normals<2>(0.05);  // of a ray from the middle
    const Mat3 H = warp.homography(slope);
    const Vec3 ray(warp.ray_0.x() + off.x(), warp.ray_0.y() + off.y(), 1);
    const auto seen = [&](const Vec2& d) {
      const Vec3 p = warp.homography(slope + d) * ray;
      return Vec2(p.x() / p.z(), p.y() / p.z());
    };
    // About the middle, with steps by rays: the aligner's coordinates with a half side of 1 ray.
    Mat3 to_ray = Mat3::Identity();
    to_ray.col(2).head<2>() = warp.ray_0;
    SlopesWarp slopes;
    slopes.t = warp.t;
    slopes.begin(H * to_ray);
    const Vec3 p = H * ray;
    Mat23 J_ray;
    J_ray << 1 / p.z(), 0, -p.x() / (p.z() * p.z()), 0, 1 / p.z(), -p.y() / (p.z() * p.z());
    const Mat2 J = J_ray * H.leftCols<2>() * slopes.jacobian(off.x(), off.y());
    check_jacobian<2, 2>(J, seen, "J_pixel_slope");
  }
}

void test_homography_should_be_that_of_the_plane() {
  SeededRandom random(642);
  for (int trial = 0; trial < 20; ++trial) {
    const TemplateWarp warp = random_warp(random);
    const Vec2 slope = random.normals<2>(0.3);
    // The plane through the middle at depth 2: n . p = d.
    const Vec3 n = warp.normal_of(slope), middle = 2 * Vec3(warp.ray_0.x(), warp.ray_0.y(), 1);
    const Mat3 H = warp.R_CK + (2 * warp.t) * n.transpose() / n.dot(middle);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, static_cast<double>((H - warp.homography(slope)).norm()));
    Vec2 again;
    TEST_ASSERT_TRUE(warp.slope_of(n, &again) && warp.slope_of(-n, &again));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, static_cast<double>((again - slope).norm()));
    // Facing: the normal is along the ray.
    const Vec3 facing = warp.normal_of(warp.facing()), ray(warp.ray_0.x(), warp.ray_0.y(), 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -1, static_cast<double>(facing.dot(ray.normalized())));
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_slopes_should_move_pixels_as_the_aligner_says);
  RUN_TEST(test_homography_should_be_that_of_the_plane);
  return UNITY_END();
}
