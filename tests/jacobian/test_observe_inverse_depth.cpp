// Jacobians of an inverse-depth point's pixel, for every camera model, near, far and at infinity, in double and in float.
#include "observe/inverse_depth.h"
#include "same.h"
#include "support/filter_cases.h"
#include "support/numeric_jacobian.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

struct Case {
  Camera camera;
  Body body;
  Vec3 o_W;
  InverseDepth feature;
};

Case draw(SeededRandom& random, int trial) {
  Case c;
  c.camera = test_camera_of(trial % kTestCameras);
  c.body = random_body(random);
  c.o_W = c.body.p_W + random.normals<3>(0.2);
  c.feature = inverse_depth_of(random, point_in_view(random, c.body), c.o_W);
  return c;
}

Vec2 pixel(const Camera& camera, const Body& body, const Vec3& o_W, const InverseDepth& feature) {
  Vec2 z = Vec2::Zero();
  Mat26 J_body;
  Mat23 J_anchor, J_feature;
  TEST_ASSERT_TRUE(observe_inverse_depth(camera, camera_at(body), o_W, feature, &z, &J_body, &J_anchor, &J_feature));
  return z;
}

void check(const Case& c) {
  Vec2 z;
  Mat26 J_z_body;
  Mat23 J_z_anchor, J_z_feature;
  TEST_ASSERT_TRUE(
      observe_inverse_depth(c.camera, camera_at(c.body), c.o_W, c.feature, &z, &J_z_body, &J_z_anchor, &J_z_feature));
  const Scalar unit = Scalar(0.5);
  check_jacobian<2, 6>(
      J_z_body, [&](const Vec6& e) { return pixel(c.camera, moved(c.body, e), c.o_W, c.feature); }, "J_z_body", unit);
  check_jacobian<2, 3>(
      J_z_anchor, [&](const Vec3& e) { return pixel(c.camera, c.body, c.o_W + e, c.feature); }, "J_z_anchor", unit);
  check_jacobian<2, 3>(
      J_z_feature, [&](const Vec3& e) { return pixel(c.camera, c.body, c.o_W, moved(c.feature, e)); }, "J_z_feature",
      unit);
}

void test_inverse_depth_jacobians_should_be_exact_with_every_camera_model() {
  SeededRandom random(44);
  for (int trial = 0; trial < 40; ++trial) check(draw(random, trial));
}

void test_inverse_depth_jacobians_should_be_exact_for_a_point_at_infinity() {
  SeededRandom random(45);
  for (int trial = 0; trial < 20; ++trial) {
    Case c = draw(random, trial);
    c.feature = inverse_depth_of(random, point_in_view(random, c.body), c.body.p_W);
    c.feature.rho = 0;
    check(c);
  }
}

void test_inverse_depth_pixel_should_be_that_of_its_3d_point() {
  SeededRandom random(46);
  for (int trial = 0; trial < 40; ++trial) {
    const Case c = draw(random, trial);
    Mat3 J;
    const Vec3 p_C = c.body.q_WC.conjugate() * (inverse_depth_to_point(c.o_W, c.feature, &J) - c.body.p_W);
    Vec2 expected;
    TEST_ASSERT_TRUE(project(c.camera, p_C, &expected));
    TEST_ASSERT_TRUE((pixel(c.camera, c.body, c.o_W, c.feature) - expected).norm() <
                     (kNumericJacobianIsFloat ? Scalar(1e-2) : Scalar(1e-9)));
  }
}

/// Bearing of a new feature: both rows against central differences of the turn and of the pixel.
void test_first_bearing_jacobians_should_be_exact_with_every_camera_model() {
  SeededRandom random(47);
  for (int trial = 0; trial < 40; ++trial) {
    const Camera camera = test_camera_of(trial % kTestCameras);
    const Body body = random_body(random);
    Vec2 z;
    TEST_ASSERT_TRUE(project(camera, body.q_WC.conjugate() * (point_in_view(random, body) - body.p_W), &z));
    Vec3 ray;
    Mat32 J_ray_z;
    TEST_ASSERT_TRUE(unproject(camera, z, &ray, &J_ray_z));
    Mat23 J_theta, J_c;
    Mat2 J_z;
    const Scalar rho = Scalar(0.5);
    const Vec3 c_W = random.normals<3>(trial % 2 == 0 ? 0.0 : 0.02);  // where the ray begins, beside the anchor
    const InverseDepth feature = begin_inverse_depth(camera_at(body), ray, J_ray_z, rho, c_W, &J_theta, &J_z, &J_c);
    const Mat3 R_b = feature.q_b.toRotationMatrix();
    const auto from_anchor = [&](const Vec3& r_W, const Vec3& c, Scalar inverse) -> Vec3 {
      return (r_W + inverse * c).normalized();
    };
    TEST_ASSERT_TRUE((R_b.col(2) - from_anchor(body.q_WC * ray, c_W, rho)).norm() <
                     (kNumericJacobianIsFloat ? Scalar(1e-5) : Scalar(1e-13)));
    TEST_ASSERT_SAME(Scalar(0.5), feature.rho);
    const auto bearing_error = [&](const Vec3& b) -> Vec2 { return R_b.leftCols<2>().transpose() * b; };
    check_jacobian<2, 3>(
        J_theta, [&](const Vec3& e) { return bearing_error(from_anchor(exp_so3(e) * body.q_WC * ray, c_W, rho)); },
        "J_feature_theta");
    check_jacobian<2, 3>(
        J_c, [&](const Vec3& e) { return bearing_error(from_anchor(body.q_WC * ray, c_W + e, rho)); }, "J_feature_c");
    check_jacobian<2, 1>(
        Vec2(J_c * c_W / rho),
        [&](const Eigen::Matrix<Scalar, 1, 1>& e) {
          return bearing_error(from_anchor(body.q_WC * ray, c_W, rho + e(0)));
        },
        "J_feature_rho");
    const auto of_pixel = [&](const Vec2& e) {
      Vec3 r;
      TEST_ASSERT_TRUE(unproject(camera, z + e, &r));
      return bearing_error(from_anchor(body.q_WC * r, c_W, rho));
    };
    // Pixels are small against the focal length: a step of some pixels, held against the Jacobian per pixel.
    const Scalar unit = Scalar(100);
    check_jacobian<2, 2>(J_z, of_pixel, "J_feature_z", unit, kNumericJacobianIsFloat ? Scalar(1e-5) : Scalar(1e-10));
  }
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_inverse_depth_jacobians_should_be_exact_with_every_camera_model);
  RUN_TEST(test_inverse_depth_jacobians_should_be_exact_for_a_point_at_infinity);
  RUN_TEST(test_inverse_depth_pixel_should_be_that_of_its_3d_point);
  RUN_TEST(test_first_bearing_jacobians_should_be_exact_with_every_camera_model);
  return UNITY_END();
}
