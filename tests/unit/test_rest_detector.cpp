// Standing still: detected from samples and pixels together, and from neither alone.
#include "inertial/rest_detector.h"
#include "support/seeded_random.h"
#include "support/textured_images.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr std::int64_t kSampleNs = 5000000, kFrameNs = 33333333;

/// A unit and a camera for some seconds.
struct Bench {
  TestArena arena;
  Settings settings;
  Frame frame;
  ImuLog log;
  UnitNoise noise{settings, log};
  RestDetector detector{settings, frame, log, noise};
  SeededRandom random{321};
  Vec3 gyro = Vec3(Scalar(0.02), Scalar(-0.01), Scalar(0.03));
  Scalar shake = 0;           ///< [m/s^2] on top of the unit's noise
  Vec2 drift = Vec2::Zero();  ///< of the picture [px/s]
  Scalar growth = 0;          ///< of the picture about its middle [1/s]
  RestReading rest;

  Bench() {
    settings.inertial = true;
    settings.unit.noise = {Scalar(2e-4), Scalar(2e-3), Scalar(2e-5), Scalar(3e-3)};
    settings.unit.gravity = Scalar(9.81);
    detector.layout(*arena);
    detector.init();
    frame.layout(*arena, 40);
    frame.init();
    log.layout(*arena, 400);
    log.init(400, {});
  }

  /// Number of frames in two and a half seconds at which a rest was seen. supported: the frames' measurements support their pose.
  int seen(bool supported = true) {
    int rests = 0;
    std::int64_t sample_ns = 0;
    for (int k = 0; k < 75; ++k) {
      const std::int64_t t_ns = k * kFrameNs;
      for (; sample_ns <= t_ns; sample_ns += kSampleNs) add_sample(sample_ns);
      frame.begin(t_ns);
      const Scalar t = static_cast<Scalar>(t_ns) * Scalar(1e-9);
      for (int i = 0; i < 30; ++i) {
        const Vec2 c(static_cast<Scalar>(20 * (i % 6) - 50), static_cast<Scalar>(20 * (i / 6) - 40));
        const Vec2 z = Vec2(160, 120) + (1 + growth * t) * c + drift * t + random.normals<2>(0.3);
        frame.add({i, static_cast<std::uint32_t>(i + 1), MatchStatus::kInlier, BlockKind::kPoint, false, false, z,
                   Mat2::Zero(), z, Scalar(0)});
      }
      rests += detector.note(supported, &rest);
    }
    return rests;
  }

 private:
  void add_sample(std::int64_t t_ns) {
    const Vec3 g = gyro + random.normals<3>(2e-4 * std::sqrt(200.0));
    const Vec3 a = Vec3(0, Scalar(-9.81), 0) + random.normals<3>(2e-3 * std::sqrt(200.0) + static_cast<double>(shake));
    log.add({t_ns, {g.x(), g.y(), g.z()}, {a.x(), a.y(), a.z()}});
  }
};

void test_a_unit_that_lies_still_should_be_at_rest_after_a_second() {
  Bench bench;
  TEST_ASSERT_EQUAL_INT(2, bench.seen());
  TEST_ASSERT_TRUE((bench.rest.gyro - bench.gyro).norm() < Scalar(1e-3));
  TEST_ASSERT_TRUE((bench.rest.accel - Vec3(0, Scalar(-9.81), 0)).norm() < Scalar(1e-2));
}

void test_a_slow_turntable_should_not_be_at_rest() {
  Bench bench;
  bench.gyro = Vec3(0, Scalar(0.5 * 3.14159 / 180), 0);
  bench.drift = Vec2(Scalar(205) * bench.gyro.y(), 0);  // half a degree a second, focal length 205 px
  TEST_ASSERT_EQUAL_INT(0, bench.seen());
}

void test_a_camera_that_glides_forwards_should_not_be_at_rest() {
  Bench bench;
  bench.growth = Scalar(0.03);
  TEST_ASSERT_EQUAL_INT(0, bench.seen());
}

void test_a_shaken_unit_before_a_wall_that_moves_along_should_not_be_at_rest() {
  Bench bench;
  bench.shake = Scalar(0.2);
  TEST_ASSERT_EQUAL_INT(0, bench.seen());
}

void test_frames_that_support_no_pose_should_say_nothing() {
  Bench bench;
  TEST_ASSERT_EQUAL_INT(0, bench.seen(false));
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_a_unit_that_lies_still_should_be_at_rest_after_a_second);
  RUN_TEST(test_a_slow_turntable_should_not_be_at_rest);
  RUN_TEST(test_a_camera_that_glides_forwards_should_not_be_at_rest);
  RUN_TEST(test_a_shaken_unit_before_a_wall_that_moves_along_should_not_be_at_rest);
  RUN_TEST(test_frames_that_support_no_pose_should_say_nothing);
  return UNITY_END();
}
