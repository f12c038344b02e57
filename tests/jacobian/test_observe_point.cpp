// Jacobians of a 3-D point's pixel, for every camera model, in double and in float.
#include "observe/point.h"
#include "support/filter_cases.h"
#include "support/numeric_jacobian.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

void test_point_jacobians_should_be_exact_with_every_camera_model() {
  SeededRandom random(41);
  for (int trial = 0; trial < 40; ++trial) {
    const Camera camera = test_camera_of(trial % kTestCameras);
    const Body body = random_body(random);
    const Vec3 f_W = point_in_view(random, body);
    Vec2 z;
    Mat26 J_z_body;
    Mat23 J_z_point;
    TEST_ASSERT_TRUE(observe_point(camera, camera_at(body), f_W, &z, &J_z_body, &J_z_point));
    const auto pixel = [&](const Body& b, const Vec3& f) {
      Vec2 out = Vec2::Zero();
      Mat26 Jb;
      Mat23 Jf;
      TEST_ASSERT_TRUE(observe_point(camera, camera_at(b), f, &out, &Jb, &Jf));
      return out;
    };
    check_jacobian<2, 6>(
        J_z_body, [&](const Vec6& e) { return pixel(moved(body, e), f_W); }, "J_z_body", Scalar(0.5));
    check_jacobian<2, 3>(
        J_z_point, [&](const Vec3& e) { return pixel(body, f_W + e); }, "J_z_point", Scalar(0.5));
  }
}

void test_point_should_project_where_the_camera_says() {
  SeededRandom random(42);
  for (int trial = 0; trial < 40; ++trial) {
    const Camera camera = test_camera_of(trial % kTestCameras);
    const Body body = random_body(random);
    const Vec3 f_W = point_in_view(random, body);
    Vec2 z, expected;
    Mat26 J_z_body;
    Mat23 J_z_point;
    TEST_ASSERT_TRUE(observe_point(camera, camera_at(body), f_W, &z, &J_z_body, &J_z_point));
    TEST_ASSERT_TRUE(project(camera, body.q_WC.conjugate() * (f_W - body.p_W), &expected));
    TEST_ASSERT_TRUE((z - expected).norm() < (kNumericJacobianIsFloat ? Scalar(1e-2) : Scalar(1e-10)));
  }
}

void test_point_should_be_refused_when_it_lies_behind_the_camera() {
  SeededRandom random(43);
  const Body body = random_body(random);
  const Vec3 behind = body.p_W - body.q_WC * Vec3(Scalar(0.1), Scalar(0.1), 1);
  Vec2 z;
  Mat26 J_z_body;
  Mat23 J_z_point;
  TEST_ASSERT_FALSE(observe_point(pinhole_camera(), camera_at(body), behind, &z, &J_z_body, &J_z_point));
  TEST_ASSERT_FALSE(observe_point(radtan_camera(), camera_at(body), behind, &z, &J_z_body, &J_z_point));
  TEST_ASSERT_FALSE(observe_point(division_camera(), camera_at(body), behind, &z, &J_z_body, &J_z_point));
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_point_jacobians_should_be_exact_with_every_camera_model);
  RUN_TEST(test_point_should_project_where_the_camera_says);
  RUN_TEST(test_point_should_be_refused_when_it_lies_behind_the_camera);
  return UNITY_END();
}
