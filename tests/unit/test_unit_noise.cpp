// A unit's noise is learned from what its samples scatter by and from innovations, between a third and ten times what is stated.
#include <cmath>

#include "inertial/force_check.h"
#include "inertial/unit_noise.h"
#include "support/seeded_random.h"
#include "support/textured_images.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr std::int64_t kSampleNs = 5000000;

struct Bench {
  TestArena arena;
  Settings settings;
  ImuLog log;
  UnitNoise noise{settings, log};
  ForceCheck forces{settings, log};
  SeededRandom random{77};
  std::int64_t t_ns = 0;

  Bench() {
    settings.inertial = true;
    settings.unit.noise = {Scalar(2e-4), Scalar(2e-3), Scalar(2e-5), Scalar(3e-3)};
    settings.unit.gravity = Scalar(9.81);
    log.layout(*arena, 400);
    log.init(400, {});
  }

  /// Samples of `times` the stated noise about `force`, while a hand moves by `motion`.
  void run(double seconds, double times, double motion, const Vec3& force) {
    const double root = std::sqrt(200.0) * times;
    const std::int64_t end_ns = t_ns + static_cast<std::int64_t>(1e9 * seconds);
    for (int k = 0; t_ns < end_ns; t_ns += kSampleNs) {
      const double t = 1e-9 * static_cast<double>(t_ns);
      const Vec3 hand =
          Vec3(Scalar(std::sin(9 * t)), Scalar(std::sin(13 * t)), Scalar(std::sin(5 * t))) * Scalar(motion);
      const Vec3 g = hand + random.normals<3>(2e-4 * root), a = force + 3 * hand + random.normals<3>(2e-3 * root);
      log.add({t_ns, {g.x(), g.y(), g.z()}, {a.x(), a.y(), a.z()}});
      if (++k % 8 == 0) {
        noise.note_samples();
        forces.note(Mat3::Identity(), true);
      }
    }
  }
  double ratio(UnitNoise::Sensor sensor) const { return static_cast<double>(noise.ratio(sensor)); }
  UnitReason reason() const {
    Scalar value;
    return forces.reason(&value);
  }
};

const Vec3 kUp(0, 0, Scalar(9.81));

void test_white_noise_should_be_learned_both_ways_and_motion_be_none() {
  for (const double times : {0.5, 1.0, 3.0}) {
    for (const double motion : {0.0, 0.5}) {
      Bench unit;
      unit.run(8, times, motion, kUp);
      TEST_ASSERT_DOUBLE_WITHIN(0.15 * times, times, unit.ratio(UnitNoise::kGyro));
      TEST_ASSERT_DOUBLE_WITHIN(0.15 * times, times, unit.ratio(UnitNoise::kAccel));
    }
  }
  Bench unit;
  unit.run(8, 0.05, 0, kUp);
  TEST_ASSERT_DOUBLE_WITHIN(0.02, 1.0 / 3, unit.ratio(UnitNoise::kGyro));
  Bench loud;
  loud.run(8, 50, 0, kUp);
  TEST_ASSERT_DOUBLE_WITHIN(0.3, 10, loud.ratio(UnitNoise::kGyro));
}

void test_innovations_should_raise_the_noise_only_where_they_are_not_explained() {
  Bench unit;
  for (int k = 0; k < 1000; ++k) {
    const Vec3 e = unit.random.normals<3>(1);
    unit.noise.note_innovation(UnitNoise::kGyro, e.squaredNorm(), 3);
    unit.noise.note_innovation(UnitNoise::kAccel, 4 * e.squaredNorm(), 3);
  }
  TEST_ASSERT_TRUE(unit.ratio(UnitNoise::kGyro) < 1.5);
  TEST_ASSERT_TRUE(unit.noise.is_at_bound(UnitNoise::kAccel) && !unit.noise.is_at_bound(UnitNoise::kGyro));
  TEST_ASSERT_TRUE(unit.noise.now().accel_walk > 9 * unit.settings.unit.noise.accel_walk);
}

void test_an_accelerometer_that_does_not_read_gravity_should_be_named() {
  for (const double motion : {0.0, 0.2}) {
    Bench good, in_g, none, other;
    good.run(3, 1, motion, kUp);
    in_g.run(3, 1, motion / 9.81, kUp / Scalar(9.81));
    none.run(3, 1, motion, Vec3::Zero());
    other.run(3, 1, motion, kUp * 1000);
    TEST_ASSERT_TRUE(good.reason() == UnitReason::kNone);
    TEST_ASSERT_TRUE(in_g.reason() == UnitReason::kAccelInG);
    TEST_ASSERT_TRUE(none.reason() == UnitReason::kAccelWithoutGravity);
    TEST_ASSERT_TRUE(other.reason() == UnitReason::kAccelUnit);
  }
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_white_noise_should_be_learned_both_ways_and_motion_be_none);
  RUN_TEST(test_innovations_should_raise_the_noise_only_where_they_are_not_explained);
  RUN_TEST(test_an_accelerometer_that_does_not_read_gravity_should_be_named);
  return UNITY_END();
}
