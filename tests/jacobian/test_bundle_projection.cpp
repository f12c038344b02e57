// The bundle's projection: Jacobians by pose, host and inverse depth, for every camera model, in double and in float.
#include "bundle/bearing.h"
#include "geometry/so3.h"
#include "same.h"
#include "support/numeric_jacobian.h"
#include "support/seeded_random.h"
#include "support/test_cameras.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

void test_bundle_projection_jacobians_should_be_exact_for_every_camera_model() {
  SeededRandom random(41);
  for (int trial = 0; trial < 40; ++trial) {
    const Camera camera = test_camera_of(trial % 4);
    const Mat3 R_WC = exp_so3(random.normals<3>(0.1)).toRotationMatrix();
    const Mat3 R_WH = exp_so3(random.normals<3>(0.1)).toRotationMatrix();
    const Vec3 p_C = random.normals<3>(0.1), p_H = random.normals<3>(0.1);
    Vec3 ray(0, 0, 1);
    ray.head<2>() = random.normals<2>(0.1);
    const Scalar rho = static_cast<Scalar>(random.uniform(0.1, 1));
    Vec2 z, J_z_rho;
    Mat26 J_z_C, J_z_H;
    TEST_ASSERT_TRUE(
        project_bearing(camera, R_WC, R_WH.lazyProduct(ray), p_H - p_C, rho, &z, &J_z_C, &J_z_H, &J_z_rho));

    const auto moved = [&](const Vec6& c, const Vec6& h, Scalar e) {
      const Mat3 R_C = exp_so3(c.head<3>()).toRotationMatrix().lazyProduct(R_WC);
      const Mat3 R_H = exp_so3(h.head<3>()).toRotationMatrix().lazyProduct(R_WH);
      Vec2 at = Vec2::Zero();
      project_bearing(camera, R_C, R_H.lazyProduct(ray), p_H + h.tail<3>() - p_C - c.tail<3>(), rho + e, &at);
      return at;
    };
    const Vec6 none = Vec6::Zero();
    check_jacobian<2, 6>(
        J_z_C, [&](const Vec6& e) { return moved(e, none, 0); }, "J_z_C");
    check_jacobian<2, 6>(
        J_z_H, [&](const Vec6& e) { return moved(none, e, 0); }, "J_z_H");
    using Vec1 = Eigen::Matrix<Scalar, 1, 1>;
    check_jacobian<2, 1>(
        J_z_rho, [&](const Vec1& e) { return moved(none, none, e(0)); }, "J_z_rho");
  }
}

void test_bundle_projection_should_leave_its_outputs_when_the_point_is_behind() {
  const Camera camera = test_camera_of(0);
  Vec2 z(7, 8);
  Mat26 J = Mat26::Constant(9);
  const Vec3 behind(0, 0, -1);
  TEST_ASSERT_FALSE(project_bearing(camera, Mat3::Identity(), behind, Vec3::Zero(), 1, &z, &J));
  TEST_ASSERT_SAME(Vec2(7, 8), z);
  TEST_ASSERT_SAME(Mat26::Constant(9), J);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_bundle_projection_jacobians_should_be_exact_for_every_camera_model);
  RUN_TEST(test_bundle_projection_should_leave_its_outputs_when_the_point_is_behind);
  return UNITY_END();
}
