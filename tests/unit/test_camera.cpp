// Camera models: published formulas, round trips, domains, and what a calibration must look like.
#include <cmath>
#include <limits>

#include "geometry/camera.h"
#include "same.h"
#include "support/numeric_jacobian.h"
#include "support/test_cameras.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr bool kFloat = sizeof(Scalar) == 4;
constexpr double kPixelTolerance = kFloat ? 2e-3 : 1e-10;

Vec3 vec3(double x, double y, double z) {
  return Vec3(static_cast<Scalar>(x), static_cast<Scalar>(y), static_cast<Scalar>(z));
}

void expect_pixel(const Camera& camera, const Vec3& p, double u, double v) {
  Vec2 pixel;
  TEST_ASSERT_TRUE(project(camera, p, &pixel));
  TEST_ASSERT_DOUBLE_WITHIN(kPixelTolerance, u, static_cast<double>(pixel.x()));
  TEST_ASSERT_DOUBLE_WITHIN(kPixelTolerance, v, static_cast<double>(pixel.y()));
}

void test_projection_should_follow_the_published_formulas_when_points_are_given() {
  const double x = 0.31, y = -0.22, z = 1.7;
  const double a = x / z, b = y / z, r2 = a * a + b * b;
  expect_pixel(pinhole_camera(), vec3(x, y, z), 525 * a + 320, 520 * b + 240);
  {  // OpenCV's plumb bob: k1 k2 p1 p2 k3
    const double k1 = -0.2, k2 = 0.05, p1 = 0.003, p2 = -0.002, k3 = 0.01;
    const Camera c = test_camera(CameraModel::kRadtan, 640, 480, 500, 510, 321, 239, k1, k2, p1, p2, k3);
    const double radial = 1 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
    const double xd = a * radial + 2 * p1 * a * b + p2 * (r2 + 2 * a * a);
    const double yd = b * radial + p1 * (r2 + 2 * b * b) + 2 * p2 * a * b;
    expect_pixel(c, vec3(x, y, z), 500 * xd + 321, 510 * yd + 239);
  }
  {  // OpenCV's fisheye: k1 k2 k3 k4 over the angle
    const double k[4] = {0.003482389402, 0.000715034845, -0.002053236141, 0.000202936736};
    const double r = std::sqrt(r2), t = std::atan(r);
    const double td =
        t * (1 + k[0] * std::pow(t, 2) + k[1] * std::pow(t, 4) + k[2] * std::pow(t, 6) + k[3] * std::pow(t, 8));
    expect_pixel(equidistant_camera(), vec3(x, y, z), 190.978 * a * td / r + 254.931, 190.973 * b * td / r + 256.897);
  }
  {  // Harris's division model, in pixels about the principal point
    const double u = 195 * a, v = 195 * b, s = 1 / std::sqrt(1 + 2 * 9e-6 * (u * u + v * v));
    expect_pixel(division_camera(), vec3(x, y, z), u * s + 162, v * s + 125);
  }
}

void test_ray_should_project_back_to_its_pixel_when_taken_over_the_whole_image() {
  for (int k = 0; k < kTestCameras; ++k) {
    const Camera camera = test_camera_of(k);
    int seen = 0, all = 0;
    double worst = 0;
    for (int v = 0; v < camera.height; v += 7) {
      for (int u = 0; u < camera.width; u += 7) {
        const Vec2 pixel(static_cast<Scalar>(u), static_cast<Scalar>(v));
        Vec3 ray;
        Vec2 again;
        ++all;
        if (!unproject(camera, pixel, &ray)) continue;
        ++seen;
        TEST_ASSERT_DOUBLE_WITHIN(kFloat ? 1e-6 : 1e-14, 1, static_cast<double>(ray.norm()));
        TEST_ASSERT_TRUE(project(camera, ray * Scalar(3), &again));
        worst = std::fmax(worst, static_cast<double>((again - pixel).norm()));
      }
    }
    TEST_ASSERT_EQUAL_INT(all, seen);
    TEST_ASSERT_DOUBLE_WITHIN(kFloat ? 5e-3 : 1e-9, 0, worst);
  }
}

void test_projection_should_refuse_when_the_point_is_behind_the_camera_or_not_finite() {
  const Scalar nan = std::numeric_limits<Scalar>::quiet_NaN(), infinity = std::numeric_limits<Scalar>::infinity();
  for (int k = 0; k < kTestCameras; ++k) {
    const Camera camera = test_camera_of(k);
    Vec2 pixel(-7, -7);
    Vec3 ray(-7, -7, -7);
    TEST_ASSERT_FALSE(project(camera, Vec3(0, 0, -1), &pixel));
    TEST_ASSERT_FALSE(project(camera, Vec3(0, 0, 0), &pixel));
    TEST_ASSERT_FALSE(project(camera, Vec3(nan, 0, 1), &pixel));
    TEST_ASSERT_FALSE(project(camera, Vec3(0, nan, 1), &pixel));
    TEST_ASSERT_FALSE(project(camera, Vec3(0, 0, nan), &pixel));
    TEST_ASSERT_FALSE(project(camera, Vec3(infinity, infinity, infinity), &pixel));
    TEST_ASSERT_FALSE(project(camera, Vec3(0, 0, infinity), &pixel));
    TEST_ASSERT_FALSE(unproject(camera, Vec2(nan, 3), &ray));
    TEST_ASSERT_FALSE(unproject(camera, Vec2(3, infinity), &ray));
    TEST_ASSERT_SAME(Vec2(-7, -7), pixel);
    TEST_ASSERT_SAME(Vec3(-7, -7, -7), ray);
    if (k != 2) TEST_ASSERT_FALSE(project(camera, Vec3(1, 0, Scalar(-0.1)), &pixel));
  }
}

void test_equidistant_should_see_behind_itself_when_the_lens_does() {
  const Camera camera = test_camera(CameraModel::kEquidistant, 1000, 1000, 150, 150, 500, 500);
  Vec2 pixel;
  TEST_ASSERT_TRUE(project(camera, vec3(1, 0, -0.5), &pixel));
  TEST_ASSERT_DOUBLE_WITHIN(kPixelTolerance, 500 + 150 * std::atan2(1.0, -0.5), static_cast<double>(pixel.x()));
  Vec3 ray;
  TEST_ASSERT_TRUE(unproject(camera, pixel, &ray));
  TEST_ASSERT_TRUE(ray.z() < 0);
}

void test_projection_should_refuse_when_strong_barrel_distortion_folds_back() {
  // r (1 - 0.3 r²) turns at r² = 1 / 0.9 and comes back to the centre at r² = 1 / 0.3.
  const Camera camera = test_camera(CameraModel::kRadtan, 640, 480, 400, 400, 320, 240, -0.3);
  Vec2 pixel;
  TEST_ASSERT_TRUE(project(camera, vec3(1.04, 0, 1), &pixel));
  TEST_ASSERT_FALSE(project(camera, vec3(1.06, 0, 1), &pixel));
  TEST_ASSERT_FALSE(project(camera, vec3(1.8, 0, 1), &pixel));
  // The largest distorted radius is 0.7027: there is nothing beyond.
  Vec3 ray;
  TEST_ASSERT_TRUE(unproject(camera, Vec2(320 + 280, 240), &ray));
  TEST_ASSERT_FALSE(unproject(camera, Vec2(320 + 282, 240), &ray));
  // The same for the angle: θ (1 - 0.1 θ²) turns at θ² = 1 / 0.3.
  const Camera fish = test_camera(CameraModel::kEquidistant, 640, 480, 300, 300, 320, 240, -0.1);
  const double turn = std::sqrt(1 / 0.3);
  TEST_ASSERT_TRUE(project(fish, vec3(std::sin(turn - 0.03), 0, std::cos(turn - 0.03)), &pixel));
  TEST_ASSERT_FALSE(project(fish, vec3(std::sin(turn + 0.01), 0, std::cos(turn + 0.01)), &pixel));
}

void test_division_should_refuse_when_no_ray_reaches_the_pixel() {
  const Camera camera = division_camera();
  // All rays end up within 1 / sqrt(2 k) = 235.7 px of the principal point.
  Vec3 ray;
  TEST_ASSERT_TRUE(unproject(camera, Vec2(162 + 230, 125), &ray));
  TEST_ASSERT_FALSE(unproject(camera, Vec2(162 + 236, 125), &ray));
  const Camera pincushion = test_camera(CameraModel::kDivision, 320, 240, 195, 195, 162, 125, -9e-6);
  Vec2 pixel;
  TEST_ASSERT_TRUE(project(pincushion, vec3(230.0 / 195, 0, 1), &pixel));
  TEST_ASSERT_FALSE(project(pincushion, vec3(236.0 / 195, 0, 1), &pixel));
}

void test_domain_should_be_one_to_one_when_the_lens_is_decentred() {
  const Camera camera = test_camera(CameraModel::kRadtan, 640, 480, 500, 500, 320, 240, -0.25, 0.02, 0.01, -0.02);
  // Within the domain the Jacobian with respect to the direction keeps its sign all round.
  const double limit = std::sqrt(static_cast<double>(camera.max_r2)) * 0.999;
  for (int i = 0; i < 360; ++i) {
    const double a = i * 3.14159265358979 / 180;
    Vec2 pixel;
    Mat23 J;
    TEST_ASSERT_TRUE(project(camera, vec3(limit * std::cos(a), limit * std::sin(a), 1), &pixel, &J));
    TEST_ASSERT_TRUE(J(0, 0) * J(1, 1) - J(0, 1) * J(1, 0) > 0);
    Vec3 ray;
    TEST_ASSERT_TRUE(unproject(camera, pixel, &ray));
    TEST_ASSERT_DOUBLE_WITHIN(kFloat ? 1e-3 : 1e-8, limit * std::cos(a), static_cast<double>(ray.x() / ray.z()));
  }
}

const char* check_with(void (*change)(Camera*)) {
  Camera camera = radtan_camera();
  change(&camera);
  init_camera(&camera);
  return check_camera(camera);
}

void test_check_should_name_the_field_when_a_calibration_makes_no_sense() {
  static const Scalar nan = std::numeric_limits<Scalar>::quiet_NaN();
  TEST_ASSERT_NULL(check_with([](Camera*) {}));
  TEST_ASSERT_EQUAL_STRING("camera.model", check_with([](Camera* c) { c->model = 0; }));
  TEST_ASSERT_EQUAL_STRING("camera.model", check_with([](Camera* c) { c->model = 5; }));
  TEST_ASSERT_EQUAL_STRING("camera.width", check_with([](Camera* c) { c->width = 31; }));
  TEST_ASSERT_EQUAL_STRING("camera.height", check_with([](Camera* c) { c->height = 4097; }));
  TEST_ASSERT_EQUAL_STRING("camera.fx", check_with([](Camera* c) { c->fx = -458; }));
  TEST_ASSERT_EQUAL_STRING("camera.fx", check_with([](Camera* c) { c->fx = nan; }));
  TEST_ASSERT_EQUAL_STRING("camera.fy", check_with([](Camera* c) { c->fy = Scalar(1e9); }));
  TEST_ASSERT_EQUAL_STRING("camera.cx", check_with([](Camera* c) { c->cx = -1000; }));
  TEST_ASSERT_EQUAL_STRING("camera.cy", check_with([](Camera* c) { c->cy = nan; }));
  TEST_ASSERT_EQUAL_STRING("camera.distortion", check_with([](Camera* c) { c->distortion[1] = nan; }));
  TEST_ASSERT_EQUAL_STRING("camera.distortion", check_with([](Camera* c) { c->distortion[5] = 1; }));
  TEST_ASSERT_EQUAL_STRING("camera.distortion", check_with([](Camera* c) { c->distortion[0] = -9; }));
  TEST_ASSERT_EQUAL_STRING("camera.distortion", check_with([](Camera* c) { c->model = 1; }));
  TEST_ASSERT_EQUAL_STRING("camera.distortion", check_with([](Camera* c) {
                             *c = division_camera();
                             c->distortion[0] = Scalar(9e-4);
                           }));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_projection_should_follow_the_published_formulas_when_points_are_given);
  RUN_TEST(test_ray_should_project_back_to_its_pixel_when_taken_over_the_whole_image);
  RUN_TEST(test_projection_should_refuse_when_the_point_is_behind_the_camera_or_not_finite);
  RUN_TEST(test_equidistant_should_see_behind_itself_when_the_lens_does);
  RUN_TEST(test_projection_should_refuse_when_strong_barrel_distortion_folds_back);
  RUN_TEST(test_division_should_refuse_when_no_ray_reaches_the_pixel);
  RUN_TEST(test_domain_should_be_one_to_one_when_the_lens_is_decentred);
  RUN_TEST(test_check_should_name_the_field_when_a_calibration_makes_no_sense);
  return UNITY_END();
}
