// How far a camera may have moved for what a rotation leaves of its pixels, and what the filter makes of it.
#include "bundle/rotation_fit.h"
#include "bundle/start_bundle.h"
#include "filter/baseline.h"
#include "geometry/so3.h"
#include "support/bounds.h"
#include "support/filter_cases.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kColumns = 6, kRows = 4;
constexpr Scalar kSigmaPx = Scalar(0.3);

/// A record of one later frame, whose camera is at p_W with a rotation; distance(i) is that of feature i.
struct Seen {
  TestArena arena;
  StartRecord record;
  StartBundle bundle;
  Camera camera = pinhole_camera();

  template <typename Distance>
  Seen(const Quat& q_WC, const Vec3& p_W, Distance&& distance) {
    TEST_ASSERT_TRUE(record.layout(*arena) && bundle.layout(*arena));
    record.init();
    bundle.init();
    const int k = record.add_frame(33000000, Quat::Identity(), Vec3::Zero());
    for (int i = 0; i < kColumns * kRows; ++i) {
      const Vec2 first((static_cast<Scalar>(i % kColumns) + Scalar(0.5)) * static_cast<Scalar>(camera.width) / kColumns,
                       (static_cast<Scalar>(i / kColumns) + Scalar(0.5)) * static_cast<Scalar>(camera.height) / kRows);
      Vec3 ray;
      Vec2 pixel;
      TEST_ASSERT_TRUE(unproject(camera, first, &ray));
      record.add_feature(ray);
      const Vec3 p = ray.normalized() * distance(i);
      if (project(camera, q_WC.conjugate() * (p - p_W), &pixel)) record.add_pixel(k, i, pixel);
    }
  }

  /// Of the true place in the covariance that the record tells, squared.
  Scalar squared_sigmas(const Vec3& p_W) {
    Mat3 C;
    TEST_ASSERT_TRUE(bundle.baseline_covariance(camera, record, kSigmaPx, Scalar(1), &C));
    return p_W.dot(C.inverse() * p_W);
  }
};

void test_translation_should_leave_what_a_rotation_cannot_explain() {
  const Vec3 p_W(Scalar(0.03), Scalar(-0.02), Scalar(0.01));
  const Seen seen(Quat::Identity(), p_W, [](int) { return Scalar(1); });
  Scalar scratch[StartRecord::kMaxFeatures];
  Quat q = Quat::Identity();
  const int n = seen.record.features();
  fit_rotation(seen.camera, seen.record.rays(), seen.record.pixels(0), n, scratch, &q);
  Scalar sum = 0;
  for (int i = 0; i < n; ++i) {
    Vec2 z;
    TEST_ASSERT_TRUE(project(seen.camera, q.conjugate() * seen.record.ray(i), &z));
    sum += (seen.record.pixel(0, i) - z).squaredNorm();
  }
  Mat3 A;
  TEST_ASSERT_TRUE(translation_left(seen.camera, seen.record.rays(), seen.record.pixels(0), n, q, &A));
  const Scalar left = std::sqrt(sum / static_cast<Scalar>(n)), expected = std::sqrt(p_W.dot(A * p_W));
  std::printf("left %.4f px, expected %.4f\n", double(left), double(expected));
  TEST_ASSERT_TRUE(left > Scalar(0.8) * expected && left < Scalar(1.2) * expected);
}

void test_baseline_should_be_within_what_the_picture_tells() {
  const Quat turned = exp_so3(Vec3(Scalar(0.02), Scalar(-0.1), Scalar(0.03)));
  for (const Vec3& p_W : {Vec3(Scalar(0.05), 0, 0), Vec3(0, Scalar(0.03), Scalar(0.02)), Vec3(0, 0, Scalar(0.06))}) {
    // A wall is the worst case: a rotation explains most of the way along it.
    Seen wall(turned, p_W, [](int) { return Scalar(1); });
    Seen room(turned, p_W, [](int i) { return Scalar(0.6) + Scalar(0.2) * static_cast<Scalar>(i % 5); });
    std::printf("squared sigmas: wall %.2f, room %.2f\n", double(wall.squared_sigmas(p_W)),
                double(room.squared_sigmas(p_W)));
    TEST_ASSERT_TRUE(wall.squared_sigmas(p_W) < 4);
    TEST_ASSERT_TRUE(room.squared_sigmas(p_W) < 4);
  }
}

void test_rotation_alone_should_tell_that_the_camera_has_not_moved() {
  Seen seen(exp_so3(Vec3(0, Scalar(0.2), 0)), Vec3::Zero(), [](int) { return Scalar(1); });
  Mat3 C;
  TEST_ASSERT_TRUE(seen.bundle.baseline_covariance(seen.camera, seen.record, kSigmaPx, Scalar(1), &C));
  TEST_ASSERT_TRUE(std::sqrt(C.diagonal().maxCoeff()) < Scalar(0.05));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_translation_should_leave_what_a_rotation_cannot_explain);
  RUN_TEST(test_baseline_should_be_within_what_the_picture_tells);
  RUN_TEST(test_rotation_alone_should_tell_that_the_camera_has_not_moved);
  return UNITY_END();
}
