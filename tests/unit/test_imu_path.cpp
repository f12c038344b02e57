// Samples between two times: ends between samples, samples that are late, missing or not there at all.
#include "filter/imu_path.h"
#include "filter/sample_sums.h"
#include "geometry/so3.h"
#include "same.h"
#include "support/textured_images.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr std::int64_t kIntervalNs = 5000000;
const Vec3 kRate(Scalar(0.3), Scalar(-0.8), Scalar(0.5)), kForce(Scalar(1), Scalar(-9), Scalar(2));
constexpr ImuNoise kNoise = {Scalar(2e-4), Scalar(2e-3), Scalar(2e-5), Scalar(3e-3)};
constexpr Scalar kNear = sizeof(Scalar) == 8 ? Scalar(1e-9) : Scalar(1e-4);

struct Path {
  TestArena arena;
  ImuLog log;
  Coasting coasting;
  Preintegral sum{kNoise, Vec3::Zero(), Vec3::Zero()};
  ImuReading end;

  Path() {
    log.layout(*arena, 200);
    log.init(200, {});
    coasting.noise = {Scalar(1), Scalar(2)};
  }
  /// A sample at so many intervals, of a unit whose rate grows by `growth` of itself a second.
  void add(int k, Scalar growth = 0) {
    const Scalar factor = 1 + growth * static_cast<Scalar>(k) * Scalar(0.005);
    const Vec3 rate = factor * kRate;
    log.add({k * kIntervalNs, {rate.x(), rate.y(), rate.z()}, {kForce.x(), kForce.y(), kForce.z()}});
  }
  Scalar integrate(std::int64_t from_ns, std::int64_t to_ns) {
    return integrate_samples(log, from_ns, to_ns, coasting, &sum, &end);
  }
};

void test_ends_between_samples_should_be_on_the_line_between_them() {
  Path path;
  for (int k = 0; k < 40; ++k) path.add(k, Scalar(2));
  TEST_ASSERT_SAME(Scalar(0), path.integrate(21500000, 57200000));
  const Scalar a = Scalar(0.0215), b = Scalar(0.0572);
  TEST_ASSERT_TRUE(std::abs(path.sum.dt() - (b - a)) < kNear);
  // All rotations are about one axis: the angle is the integral of 1 + 2 t.
  const Vec3 turn = log_so3(Quat(path.sum.R()));
  TEST_ASSERT_TRUE((turn - kRate * ((b - a) + (b * b - a * a))).norm() < kNear);
  TEST_ASSERT_TRUE((path.end.gyro - kRate * (1 + 2 * b)).norm() < Scalar(10) * kNear);
}

void test_a_reading_should_be_on_the_line_and_never_in_a_gap() {
  Path path;
  for (int k = 0; k < 60; ++k)
    if (k < 20 || k > 24) path.add(k, Scalar(2));
  ImuReading reading;
  TEST_ASSERT_TRUE(reading_at(path.log, 52500000, &reading));
  TEST_ASSERT_TRUE((reading.gyro - kRate * Scalar(1.105)).norm() < Scalar(10) * kNear);
  TEST_ASSERT_FALSE(reading_at(path.log, 110000000, &reading));  // in the gap
  TEST_ASSERT_TRUE(reading_at(path.log, 59 * kIntervalNs + 3000000, &reading));
  TEST_ASSERT_TRUE((reading.gyro - kRate * Scalar(1.596)).norm() < Scalar(10) * kNear);
  TEST_ASSERT_FALSE(reading_at(path.log, 59 * kIntervalNs + 9000000, &reading));
  TEST_ASSERT_FALSE(reading_at(path.log, -1000000, &reading));
}

void test_a_frame_behind_the_last_sample_should_go_on_along_the_last_two() {
  Path path;
  for (int k = 0; k < 40; ++k) path.add(k, Scalar(2));
  const std::int64_t to_ns = 39 * kIntervalNs + 4000000;
  TEST_ASSERT_SAME(Scalar(0), path.integrate(20 * kIntervalNs, to_ns));
  const Scalar b = Scalar(0.199);
  TEST_ASSERT_TRUE((path.end.gyro - kRate * (1 + 2 * b)).norm() < Scalar(10) * kNear);
}

void test_a_frame_far_behind_the_last_sample_should_coast() {
  Path path, there;
  for (int k = 0; k < 40; ++k) path.add(k);
  for (int k = 0; k < 80; ++k) there.add(k);
  const std::int64_t to_ns = 39 * kIntervalNs + 50000000;
  const Scalar coasted = path.integrate(20 * kIntervalNs, to_ns);
  TEST_ASSERT_TRUE(std::abs(coasted - Scalar(0.0425)) < Scalar(1e-6));
  TEST_ASSERT_SAME(Scalar(0), there.integrate(20 * kIntervalNs, to_ns));
  // The rate goes on, and is far less certain.
  TEST_ASSERT_TRUE((path.sum.R() - there.sum.R()).norm() < Scalar(1e-4));
  TEST_ASSERT_TRUE(path.sum.covariance()(0, 0) > 100 * there.sum.covariance()(0, 0));
}

void test_missing_samples_should_be_bridged_with_more_noise() {
  Path whole, gap;
  for (int k = 0; k < 40; ++k) {
    whole.add(k);
    if (k < 20 || k >= 28) gap.add(k);
  }
  TEST_ASSERT_SAME(Scalar(0), whole.integrate(10 * kIntervalNs, 35 * kIntervalNs));
  TEST_ASSERT_SAME(Scalar(0), gap.integrate(10 * kIntervalNs, 35 * kIntervalNs));
  TEST_ASSERT_TRUE((whole.sum.R() - gap.sum.R()).norm() < Scalar(1e-4));
  for (int i = 0; i < 9; ++i) TEST_ASSERT_TRUE(gap.sum.covariance()(i, i) > 2 * whole.sum.covariance()(i, i));
}

void test_without_samples_all_time_should_be_coasted_and_a_jump_of_the_clock_should_end() {
  Path path;
  TEST_ASSERT_TRUE(std::abs(path.integrate(0, 100000000) - Scalar(0.1)) < kNear);
  const std::int64_t far[2] = {INT64_MAX, INT64_MIN + 1};
  for (const std::int64_t t_ns : far) {
    Path jump;
    for (int k = 0; k < 10; ++k) jump.add(k);
    const std::int64_t from_ns = t_ns > 0 ? 0 : t_ns, to_ns = t_ns > 0 ? t_ns : 0;
    TEST_ASSERT_TRUE(jump.integrate(from_ns, to_ns) <= Scalar(2));
    TEST_ASSERT_TRUE(jump.sum.covariance().allFinite());
  }
}

void test_samples_on_both_sides_of_a_jump_of_the_clock_should_be_coasted_between() {
  constexpr std::int64_t kYears = 44;
  for (const int jumps : {1, 20}) {
    Path jump;
    std::int64_t shift_ns = 0;
    for (int k = 0; k < 100; ++k) {
      if (k >= 20 && k < 20 + jumps) shift_ns += kYears * 31556952 * INT64_C(1000000000) / jumps;
      const std::int64_t t_ns = k * kIntervalNs + shift_ns;
      jump.log.add({t_ns, {kRate.x(), kRate.y(), kRate.z()}, {kForce.x(), kForce.y(), kForce.z()}});
    }
    TEST_ASSERT_SAME(Scalar(2), jump.integrate(10 * kIntervalNs, 90 * kIntervalNs + shift_ns));
    TEST_ASSERT_TRUE(jump.sum.dt() < Scalar(2.5));
    TEST_ASSERT_TRUE((jump.end.gyro - kRate).norm() < Scalar(10) * kNear);
    for (int i = 0; i < 9; ++i) TEST_ASSERT_TRUE(jump.sum.covariance()(i, i) < 1000);  // that of 2 s, and what follows
    TEST_ASSERT_TRUE(jump.sum.p().norm() < 100 && jump.sum.v().norm() < 100);
  }
}

SampleSums kept(const Preintegral& sum) {
  return {sum.dt(), sum.gyro_bias(), Quat(sum.R()), sum.v(), sum.p(), sum.by_bias().cast<float>()};
}

/// Also where both parts were integrated with other biases.
void test_two_times_together_should_be_the_time_of_both() {
  constexpr std::int64_t kMiddle = 20 * kIntervalNs, kEnd = 39 * kIntervalNs;
  const Vec3 more(Scalar(0.002), Scalar(-0.001), Scalar(0.003));
  Path whole, before, after;
  after.sum = Preintegral(kNoise, more, Vec3::Zero());
  for (Path* path : {&whole, &before, &after})
    for (int k = 0; k < 40; ++k) path->add(k, Scalar(2));
  whole.integrate(0, kEnd);
  before.integrate(0, kMiddle);
  after.integrate(kMiddle, kEnd);
  SampleSums both = kept(after.sum);
  both.begin_with(kept(before.sum));
  const SampleSums once = kept(whole.sum);
  TEST_ASSERT_TRUE(std::abs(both.dt - once.dt) < kNear);
  TEST_ASSERT_TRUE(both.dq_B.angularDistance(once.dq_B) < Scalar(1e-5));
  TEST_ASSERT_TRUE((both.v - once.v).norm() < Scalar(1e-5) && (both.p - once.p).norm() < Scalar(1e-5));
  TEST_ASSERT_TRUE((both.by_bias - once.by_bias).norm() < 1e-3F * once.by_bias.norm());
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_ends_between_samples_should_be_on_the_line_between_them);
  RUN_TEST(test_a_reading_should_be_on_the_line_and_never_in_a_gap);
  RUN_TEST(test_a_frame_behind_the_last_sample_should_go_on_along_the_last_two);
  RUN_TEST(test_a_frame_far_behind_the_last_sample_should_coast);
  RUN_TEST(test_missing_samples_should_be_bridged_with_more_noise);
  RUN_TEST(test_samples_on_both_sides_of_a_jump_of_the_clock_should_be_coasted_between);
  RUN_TEST(test_without_samples_all_time_should_be_coasted_and_a_jump_of_the_clock_should_end);
  RUN_TEST(test_two_times_together_should_be_the_time_of_both);
  return UNITY_END();
}
