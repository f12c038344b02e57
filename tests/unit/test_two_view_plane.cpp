// The plane of points that two cameras with known poses see: exact without noise, and refused where nothing tells it.
#include "geometry/so3.h"
#include "geometry/two_view_plane.h"
#include "same.h"
#include "support/numeric_jacobian.h"
#include "support/seeded_random.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kRays = 4;

struct Views {
  Vec3 ray_K[kRays], ray_C[kRays], t_CK[kRays];
  Mat3 R_CK[kRays];
  Vec3 m = Vec3::Zero();

  /// A square of a plane about 2 m before K; each of its corners is seen by C from a place of its own, as rows of a rolling shutter are.
  Views(SeededRandom* random, Scalar baseline) {
    Vec3 n = Vec3(Scalar(0), Scalar(0), Scalar(1)) + random->normals<3>(0.3);
    n.normalize();
    const Scalar d = Scalar(random->uniform(1.5, 3));
    m = n / d;
    const Vec3 aside = random->normals<3>(1);
    for (int k = 0; k < kRays; ++k) {
      ray_K[k] = Vec3(k == 1 || k == 2 ? Scalar(0.2) : Scalar(0), k >= 2 ? Scalar(0.2) : Scalar(0), Scalar(1));
      const Vec3 p_K = ray_K[k] / m.dot(ray_K[k]);
      R_CK[k] = exp_so3(Vec3(random->normals<3>(0.1))).toRotationMatrix();
      t_CK[k] = baseline * (aside.normalized() + random->normals<3>(0.1));
      ray_C[k] = (R_CK[k] * p_K + t_CK[k]) * Scalar(random->uniform(0.3, 2));
    }
  }
};

void test_the_plane_should_be_exact_without_noise() {
  SeededRandom random(17);
  for (int trial = 0; trial < 50; ++trial) {
    const Views views(&random, Scalar(0.3));
    Vec3 m;
    TEST_ASSERT_TRUE(two_view_plane(views.ray_K, views.ray_C, views.R_CK, views.t_CK, kRays, &m));
    TEST_ASSERT_TRUE((m - views.m).norm() < (kNumericJacobianIsFloat ? Scalar(1e-3) : Scalar(1e-10)) * views.m.norm());
  }
}

void test_a_camera_that_has_only_turned_should_tell_nothing() {
  SeededRandom random(18);
  const Views views(&random, Scalar(0));
  Vec3 m = Vec3::Constant(Scalar(5));
  TEST_ASSERT_FALSE(two_view_plane(views.ray_K, views.ray_C, views.R_CK, views.t_CK, kRays, &m));
  TEST_ASSERT_SAME(Vec3::Constant(Scalar(5)), m);
}

void test_points_behind_a_camera_should_be_refused() {
  SeededRandom random(19);
  Views views(&random, Scalar(0.3));
  for (Vec3& t : views.t_CK) t = -t;  // the parallax is that of a plane behind K
  Vec3 m;
  TEST_ASSERT_FALSE(two_view_plane(views.ray_K, views.ray_C, views.R_CK, views.t_CK, kRays, &m));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_the_plane_should_be_exact_without_noise);
  RUN_TEST(test_a_camera_that_has_only_turned_should_tell_nothing);
  RUN_TEST(test_points_behind_a_camera_should_be_refused);
  return UNITY_END();
}
