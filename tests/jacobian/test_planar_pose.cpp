// Jacobian of a pixel with respect to the pose, about any pivot, in double and in float.
#include "geometry/planar_pose.h"
#include "geometry/so3.h"
#include "support/numeric_jacobian.h"
#include "support/seeded_random.h"
#include "support/test_cameras.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

void test_pose_jacobian_should_be_exact_when_turned_about_any_pivot() {
  SeededRandom random(71);
  for (int k = 0; k < kTestCameras; ++k) {
    const Camera camera = test_camera_of(k);
    for (int i = 0; i < 20; ++i) {
      const Quat q_WC = exp_so3(random.normals<3>(0.5));
      const Vec3 p_WC = random.normals<3>(0.3), pivot = i % 2 == 0 ? p_WC : random.normals<3>(1);
      const Vec3 p_W = p_WC + q_WC * Vec3(Scalar(0.3) * random.normals<3>(1) + Vec3(0, 0, 2));
      Vec2 pixel;
      Mat26 J;
      TEST_ASSERT_TRUE(project_from_pose(camera, q_WC, p_WC, p_W, pivot, &pixel, &J));
      auto f = [&](const Vec6& d) {
        const Quat turn = exp_so3(d.head<3>());
        Vec2 z;
        TEST_ASSERT_TRUE(
            project_from_pose(camera, turn * q_WC, pivot + turn * (p_WC - pivot) + d.tail<3>(), p_W, pivot, &z));
        return z;
      };
      check_jacobian<2, 6>(J, f, "J_pixel_pose");

      // The same point as m / w, and as a direction.
      for (const Scalar w : {Scalar(0.4), Scalar(0)}) {
        const Vec3 m = w > Scalar(0) ? Vec3(w * p_W) : Vec3(p_W - p_WC);
        TEST_ASSERT_TRUE(project_from_pose(camera, q_WC, p_WC, m, w, pivot, &pixel, &J));
        const auto scaled = [&](const Vec6& d) {
          const Quat turn = exp_so3(d.head<3>());
          Vec2 z;
          TEST_ASSERT_TRUE(
              project_from_pose(camera, turn * q_WC, pivot + turn * (p_WC - pivot) + d.tail<3>(), m, w, pivot, &z));
          return z;
        };
        check_jacobian<2, 6>(J, scaled, "J_pixel_pose of m / w");
      }
    }
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_pose_jacobian_should_be_exact_when_turned_about_any_pivot);
  return UNITY_END();
}
