// Jacobians of a pixel of a lens that is longer than its calibration, for every camera model.
#include "bundle/zoom_fit.h"
#include "geometry/so3.h"
#include "support/numeric_jacobian.h"
#include "support/seeded_random.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

void test_zoomed_pixel_jacobians_should_be_exact_with_every_camera_model() {
  SeededRandom random(483);
  for (int trial = 0; trial < 40; ++trial) {
    const Camera camera = test_camera_of(trial % kTestCameras);
    const Scalar s = static_cast<Scalar>(random.uniform(-0.2, 0.2));
    CameraPose pose;
    pose.q_WC = exp_so3(Vec3(Scalar(0.1), Scalar(-0.05), Scalar(0.2)));
    pose.p_WC = Vec3(Scalar(0.1), Scalar(0.2), Scalar(-0.1));
    const Scalar depth = static_cast<Scalar>(random.uniform(1, 3));
    const Vec3 p_C(static_cast<Scalar>(random.uniform(-0.3, 0.3)) * depth,
                   static_cast<Scalar>(random.uniform(-0.3, 0.3)) * depth, depth);
    const PnpPoint point = {pose.p_WC + pose.q_WC * p_C, Scalar(1), Vec2::Zero()};
    Vec2 u, J_s;
    Mat26 J_pose;
    TEST_ASSERT_TRUE(project_zoomed(camera, pose, s, point, &u, &J_pose, &J_s));
    const auto pixel = [&](const Vec6& e, Scalar at) {
      CameraPose moved = pose;
      moved.q_WC = exp_so3(Vec3(e.head<3>())) * pose.q_WC;
      moved.p_WC += e.tail<3>();
      Vec2 out = Vec2::Zero(), by_s;
      Mat26 by_pose;
      TEST_ASSERT_TRUE(project_zoomed(camera, moved, at, point, &out, &by_pose, &by_s));
      return out;
    };
    check_jacobian<2, 6>(
        J_pose, [&](const Vec6& e) { return pixel(e, s); }, "J_pose", Scalar(0.5));
    using One = Eigen::Matrix<Scalar, 1, 1>;
    check_jacobian<2, 1>(
        J_s, [&](const One& e) { return pixel(Vec6::Zero(), s + e(0)); }, "J_s", Scalar(0.5));
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_zoomed_pixel_jacobians_should_be_exact_with_every_camera_model);
  return UNITY_END();
}
