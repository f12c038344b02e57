// The camera's rates against the gyroscope's: delay, axes and scale are found, and what is wrong with a unit is seen.
#include <cmath>

#include "inertial/rate_alignment.h"
#include "support/seeded_random.h"
#include "support/textured_images.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr std::int64_t kFrameNs = 40000000, kSampleNs = 5000000;
constexpr int kFrames = 60;

/// Of the camera, in its axes [rad/s].
Vec3 rate(double t) {
  return Vec3(Scalar(0.5 * std::sin(5.1 * t)), Scalar(0.4 * std::sin(3.7 * t + 1)),
              Scalar(0.3 * std::sin(7.3 * t + 2)));
}

/// A recording of a unit with `by` in place of R_BC, whose samples are stamped `delay` early.
struct Recording {
  TestArena arena;
  ImuLog log;
  RateAlignment rates;
  SeededRandom random{411};

  Recording(const Mat3& by, double delay) {
    log.layout(*arena, 1000);
    log.init(1000, {});
    for (std::int64_t t_ns = 0; t_ns < (kFrames + 10) * kFrameNs; t_ns += kSampleNs) {
      const Vec3 g =
          by * rate(1e-9 * static_cast<double>(t_ns)) + Vec3(Scalar(0.02), Scalar(-0.01), 0) + random.normals<3>(2e-3);
      log.add({t_ns - static_cast<std::int64_t>(1e9 * delay), {g.x(), g.y(), g.z()}, {0, 0, 0}});
    }
    for (int k = 5; k < kFrames; ++k) {
      const std::int64_t begin_ns = k * kFrameNs;
      Vec3 mean = Vec3::Zero();
      for (int i = 0; i < 8; ++i)
        mean += rate(1e-9 * (static_cast<double>(begin_ns) + (i + 0.5) * 0.125 * kFrameNs)) / 8;
      rates.add(begin_ns, begin_ns + kFrameNs, mean + random.normals<3>(5e-3));
    }
  }
};

const Mat3 kMount = exp_so3(Vec3(Scalar(0.3), Scalar(-1.2), Scalar(0.8))).toRotationMatrix();

void test_delay_and_axes_should_be_found_within_their_sigmas() {
  for (const double delay : {-0.07, 0.0, 0.0513, 0.15}) {
    Recording unit(kMount, delay);
    RateFit fit;
    TEST_ASSERT_TRUE(unit.rates.fit(unit.log, 0, RateAlignment::kReach, nullptr, &fit));
    TEST_ASSERT_TRUE(fit.left < Scalar(0.01) && !fit.mirrored && !fit.at_end);
    TEST_ASSERT_TRUE(fit.sigma_delay < Scalar(0.002));
    TEST_ASSERT_DOUBLE_WITHIN(4 * static_cast<double>(fit.sigma_delay) + 2e-4, delay, static_cast<double>(fit.delay));
    const Vec3 off = log_so3(Quat(Mat3(fit.R_CB * kMount)));
    TEST_ASSERT_TRUE(off.norm() < 4 * fit.sigma_turn && fit.sigma_turn < Scalar(0.02));
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 1, static_cast<double>(fit.scale));
  }
}

void test_a_delay_that_is_known_should_be_judged_and_not_searched() {
  Recording unit(kMount, 0.05);
  const Mat3 R_CB = kMount.transpose();
  RateFit fit;
  TEST_ASSERT_TRUE(unit.rates.fit(unit.log, 0.05, 0, &R_CB, &fit));
  TEST_ASSERT_TRUE(fit.left < Scalar(0.01));
  TEST_ASSERT_TRUE(unit.rates.fit(unit.log, 0, 0, &R_CB, &fit));
  TEST_ASSERT_TRUE(fit.left > Scalar(0.03));
}

void test_degrees_and_reflections_should_be_seen() {
  RateFit fit;
  Recording degrees(Mat3(Scalar(57.29578) * kMount), 0);
  TEST_ASSERT_TRUE(degrees.rates.fit(degrees.log, 0, RateAlignment::kReach, nullptr, &fit));
  TEST_ASSERT_DOUBLE_WITHIN(1, 57.3, 1 / static_cast<double>(fit.scale));
  Mat3 flipped = kMount;
  flipped.row(1) = -flipped.row(1);
  Recording mirrored(flipped, 0.03);
  TEST_ASSERT_TRUE(mirrored.rates.fit(mirrored.log, 0, RateAlignment::kReach, nullptr, &fit));
  TEST_ASSERT_TRUE(fit.mirrored && fit.left_mirrored < Scalar(0.02) && fit.left > Scalar(0.05));
}

void test_missing_samples_should_give_no_fit() {
  Recording unit(kMount, 0);
  ImuLog none;
  RateFit fit;
  TEST_ASSERT_FALSE(unit.rates.fit(none, 0, RateAlignment::kReach, nullptr, &fit));
  unit.rates.init();
  TEST_ASSERT_FALSE(unit.rates.fit(unit.log, 0, RateAlignment::kReach, nullptr, &fit));
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_delay_and_axes_should_be_found_within_their_sigmas);
  RUN_TEST(test_a_delay_that_is_known_should_be_judged_and_not_searched);
  RUN_TEST(test_degrees_and_reflections_should_be_seen);
  RUN_TEST(test_missing_samples_should_give_no_fit);
  return UNITY_END();
}
