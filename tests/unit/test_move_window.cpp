// A window that is moved as a whole: nothing in it sees that.
#include <unity.h>

#include "bundle/bearing.h"
#include "geometry/so3.h"
#include "keyframe_slam/adjustment/move_window.h"
#include "support/window_bench.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr Scalar kTight = sizeof(Scalar) == 4 ? Scalar(1e-4) : Scalar(1e-9);

void test_pixels_should_be_those_of_before_and_covariances_follow() {
  KeyframeBench bench(3);
  for (int n = 0; n < 12; ++n)
    bench.place(
        bench.add(Vec3(Scalar(0.2) * static_cast<Scalar>(n % 4) - Scalar(0.3),
                       Scalar(0.15) * static_cast<Scalar>(n / 4), Scalar(1.5) + Scalar(0.1) * static_cast<Scalar>(n)),
                  0));
  KeyframeMotion motion(bench.settings);
  Body body;
  body.p_W = Vec3(Scalar(0.1), 0, 0);
  body.v_W = Vec3(Scalar(0.2), Scalar(0.1), 0);
  motion.set(body, Mat6(Mat6::Identity() * Scalar(1e-4)), Scalar(0.1), Scalar(0.1));
  const int plane = bench.tables.planes.add(0);
  bench.planes.add_found(plane, PlaneFrame());
  const auto pixel_of = [&](int k, int i) {
    Vec2 z;
    const Keyframe& keyframe = bench.map.keyframes[k];
    TEST_ASSERT_TRUE(
        project(bench.settings.camera, keyframe.q_WC.conjugate() * (bench.map.position(i) - keyframe.p_W), &z));
    return z;
  };
  Vec2 pixel[KeyframeBench::kKeyframes][12];
  for (int k = 0; k < KeyframeBench::kKeyframes; ++k)
    for (int i = 0; i < 12; ++i) pixel[k][i] = pixel_of(k, i);
  bench.map.point(0).variance = Scalar(1e-4);
  const Vec3 p_W = bench.map.position(0);
  const Mat3 P = bench.map.covariance(0);
  const Scalar distance = plane_distance(bench.planes.plane(plane).frame, Vec3::Zero(), p_W);

  const Similarity T = {exp_so3(Vec3(Scalar(0.3), Scalar(-0.2), 1)), Vec3(1, -2, Scalar(0.5)), Scalar(1.7)};
  move_window(T, &bench.map, &bench.planes, &motion);
  for (int k = 0; k < KeyframeBench::kKeyframes; ++k)
    for (int i = 0; i < 12; ++i) TEST_ASSERT_TRUE((pixel_of(k, i) - pixel[k][i]).norm() < 1000 * kTight);
  TEST_ASSERT_TRUE((bench.map.position(0) - T.of(p_W)).norm() < 10 * kTight);
  const Mat3 sR = T.s * T.q.toRotationMatrix();
  TEST_ASSERT_TRUE((bench.map.covariance(0) - Mat3(sR * P * sR.transpose())).norm() < Scalar(1e-3) * P.norm());
  TEST_ASSERT_TRUE(std::abs(plane_distance(bench.planes.plane(plane).frame, Vec3::Zero(), bench.map.position(0)) -
                            T.s * distance) < 10 * kTight);
  TEST_ASSERT_TRUE((motion.body().p_W - T.of(body.p_W)).norm() < kTight);
  TEST_ASSERT_TRUE((motion.body().v_W - T.s * (T.q * body.v_W)).norm() < kTight);
  TEST_ASSERT_TRUE((motion.pose_covariance() - T.of_pose_covariance(Mat6(Mat6::Identity() * Scalar(1e-4)))).norm() <
                   kTight);
}

void test_a_similarity_about_a_place_should_leave_it() {
  const Vec3 c(1, 2, 3);
  const Similarity T = Similarity::about(c, Scalar(2.5));
  TEST_ASSERT_TRUE((T.of(c) - c).norm() < kTight);
  TEST_ASSERT_TRUE((T.of(Vec3(2, 2, 3)) - Vec3(Scalar(3.5), 2, 3)).norm() < kTight);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_pixels_should_be_those_of_before_and_covariances_follow);
  RUN_TEST(test_a_similarity_about_a_place_should_leave_it);
  return UNITY_END();
}
