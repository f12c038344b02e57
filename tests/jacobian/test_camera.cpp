// Jacobians of every camera model, in double and in float.
#include <cmath>

#include "geometry/camera.h"
#include "support/numeric_jacobian.h"
#include "support/test_cameras.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

/// Pixels over the image: centre, near the centre, and out to the corners.
Vec2 pixel_of(const Camera& camera, int i, int j) {
  return Vec2(static_cast<Scalar>(camera.width - 1) * static_cast<Scalar>(i) / 8,
              static_cast<Scalar>(camera.height - 1) * static_cast<Scalar>(j) / 8);
}

void check_project_at(const Camera& camera, const Vec3& p, const char* name) {
  Vec2 pixel;
  Mat23 J;
  TEST_ASSERT_TRUE(project(camera, p, &pixel, &J));
  auto f = [&](const Vec3& d) {
    Vec2 z;
    TEST_ASSERT_TRUE(project(camera, p + d, &z));
    return z;
  };
  check_jacobian<2, 3>(J, f, name, p.norm());
}

void test_projection_jacobian_should_be_exact_when_the_point_is_anywhere_in_the_image() {
  for (int k = 0; k < kTestCameras; ++k) {
    const Camera camera = test_camera_of(k);
    int seen = 0;
    for (int i = 0; i <= 8; ++i) {
      for (int j = 0; j <= 8; ++j) {
        Vec3 ray;
        if (!unproject(camera, pixel_of(camera, i, j), &ray)) continue;
        check_project_at(camera, ray * Scalar(0.4), "J_pixel_p near");
        check_project_at(camera, ray * Scalar(7), "J_pixel_p far");
        ++seen;
      }
    }
    TEST_ASSERT_GREATER_OR_EQUAL_INT(77, seen);
    check_project_at(camera, Vec3(0, 0, 2), "J_pixel_p on the axis");
    check_project_at(camera, Vec3(Scalar(1e-5), Scalar(-2e-5), 2), "J_pixel_p beside the axis");
  }
}

void test_ray_jacobian_should_be_exact_when_the_pixel_is_anywhere_in_the_image() {
  for (int k = 0; k < kTestCameras; ++k) {
    const Camera camera = test_camera_of(k);
    for (int i = 0; i <= 8; ++i) {
      for (int j = 0; j <= 8; ++j) {
        const Vec2 pixel = pixel_of(camera, i, j);
        Vec3 ray;
        Mat32 J;
        // A border of pixels, so that the steps stay inside of the domain.
        if (!unproject(camera, pixel * Scalar(1.05), &ray)) continue;
        if (!unproject(camera, pixel, &ray, &J)) continue;
        auto f = [&](const Vec2& d) {
          Vec3 r;
          TEST_ASSERT_TRUE(unproject(camera, pixel + d, &r));
          return r;
        };
        const Scalar unit = kNumericJacobianIsFloat ? 200 : 100;
        check_jacobian<3, 2>(J, f, "J_ray_pixel", unit, kNumericJacobianIsFloat ? Scalar(1e-4) : Scalar(1e-10));
      }
    }
  }
}

void test_ray_jacobian_should_undo_the_projection_when_they_are_chained() {
  for (int k = 0; k < kTestCameras; ++k) {
    const Camera camera = test_camera_of(k);
    const Vec2 pixel = pixel_of(camera, 2, 5);
    Vec3 ray;
    Vec2 again;
    Mat32 J_ray_pixel;
    Mat23 J_pixel_p;
    TEST_ASSERT_TRUE(unproject(camera, pixel, &ray, &J_ray_pixel));
    TEST_ASSERT_TRUE(project(camera, ray, &again, &J_pixel_p));
    const Mat2 chain = J_pixel_p * J_ray_pixel;
    TEST_ASSERT_TRUE((chain - Mat2::Identity()).cwiseAbs().maxCoeff() <
                     (kNumericJacobianIsFloat ? Scalar(1e-4) : Scalar(1e-11)));
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_projection_jacobian_should_be_exact_when_the_point_is_anywhere_in_the_image);
  RUN_TEST(test_ray_jacobian_should_be_exact_when_the_pixel_is_anywhere_in_the_image);
  RUN_TEST(test_ray_jacobian_should_undo_the_projection_when_they_are_chained);
  return UNITY_END();
}
