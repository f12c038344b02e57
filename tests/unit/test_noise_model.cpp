// The noise of matches: its size and its correlation in time are found from residuals, whatever was believed before.
#include <cmath>
#include <cstdio>
#include <vector>

#include "frame/noise_model.h"
#include "frame/tuning.h"
#include "same.h"
#include "support/seeded_random.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kFeatures = 40, kFrames = 400;
constexpr Scalar kPrior = Scalar(0.1);
const Mat2 kFit = Mat2::Identity() * Scalar(0.0064);

/// Residuals of sigma [px] whose correlation falls by rho from frame to frame; a share of them is wrong by 20 sigma.
NoiseModel learned(Scalar sigma, Scalar rho, double wrong = 0, Scalar prior_frames = tuning::noise::kPriorFrames) {
  SeededRandom random(11);
  NoiseModel noise;
  noise.init(kPrior, prior_frames);
  std::vector<ResidualTrace> trace(kFeatures);
  std::vector<Vec2> error(kFeatures, Vec2::Zero());
  for (int frame = 1; frame <= kFrames; ++frame) {
    for (std::size_t i = 0; i < kFeatures; ++i) {
      const Vec2 fresh = random.normals<2>(1);
      error[i] = frame == 1 ? fresh : Vec2(rho * error[i] + std::sqrt(1 - rho * rho) * fresh);
      const Scalar grow = random.uniform(0, 1) < wrong ? Scalar(20) : Scalar(1);
      noise.learn(frame, grow * sigma * error[i], noise.match(kFit, Scalar(1)), Scalar(0), &trace[i]);
    }
    noise.end_frame();
  }
  std::printf("sigma %.2f rho %.2f wrong %.2f: sigma_gate %.3f, sigma_info %.3f, %.2f frames\n", double(sigma),
              double(rho), wrong, double(noise.sigma_gate()), double(noise.sigma_info()),
              double(noise.correlation_frames()));
  return noise;
}

void test_noise_should_grow_to_the_residuals_when_they_are_larger_than_the_prior() {
  for (const Scalar sigma : {Scalar(0.2), Scalar(0.5)}) {
    const NoiseModel noise = learned(sigma, 0);
    TEST_ASSERT_TRUE(std::abs(noise.sigma_gate() - sigma) < Scalar(0.05) * sigma);
    TEST_ASSERT_TRUE(noise.correlation_frames() < Scalar(1.5));
  }
}

void test_correlation_should_be_found_when_errors_stay_with_their_features() {
  // 1 + 2 rho / (1 - lambda rho) with lambda = 15/16, less what clipping and the prior of 8 frames do to it.
  const Scalar expected[] = {Scalar(2.88), Scalar(7.4), Scalar(12.52)};
  const Scalar rho[] = {Scalar(0.5), Scalar(0.8), Scalar(0.9)};
  for (int k = 0; k < 3; ++k) {
    const NoiseModel noise = learned(Scalar(0.3), rho[k]);
    TEST_ASSERT_TRUE(std::abs(noise.correlation_frames() - expected[k]) < Scalar(0.15) * expected[k]);
    const Scalar info = noise.sigma_gate() * std::sqrt(noise.correlation_frames());
    TEST_ASSERT_TRUE(std::abs(noise.sigma_info() - info) < Scalar(1e-4));
  }
}

void test_noise_should_stay_at_the_prior_when_residuals_are_smaller() {
  const NoiseModel noise = learned(Scalar(0.02), 0);
  const Scalar prior = std::sqrt(kPrior * kPrior + kFit(0, 0));
  TEST_ASSERT_TRUE(std::abs(noise.sigma_gate() - prior) < Scalar(1e-3));
}

void test_noise_should_hardly_follow_wrong_matches() {
  const NoiseModel noise = learned(Scalar(0.3), 0, 0.05);
  TEST_ASSERT_TRUE(noise.sigma_gate() > Scalar(0.28) && noise.sigma_gate() < Scalar(0.36));
}

void test_correlation_should_stay_within_its_bounds() {
  TEST_ASSERT_TRUE(learned(Scalar(0.3), Scalar(0.999)).correlation_frames() <= Scalar(30));
  TEST_ASSERT_TRUE(learned(Scalar(0.3), Scalar(-0.9)).correlation_frames() >= Scalar(1));
}

void test_correlation_should_end_alike_when_its_prior_was_far_off() {
  const Scalar low = learned(Scalar(0.3), Scalar(0.8), 0, 2).correlation_frames();
  const Scalar high = learned(Scalar(0.3), Scalar(0.8), 0, 30).correlation_frames();
  TEST_ASSERT_TRUE(high > low && high - low < Scalar(1.5));
}

/// An inlier whose features are not averaged says how large the noise is, and nothing of its correlation.
void test_correlation_should_stay_at_its_prior_when_no_match_has_a_trace() {
  NoiseModel noise;
  noise.init(kPrior);
  for (int frame = 1; frame <= 50; ++frame) {
    for (int i = 0; i < kFeatures; ++i)
      noise.learn(frame, Vec2(Scalar(0.3), 0), noise.match(kFit, Scalar(1)), Scalar(0), nullptr);
    noise.end_frame();
  }
  TEST_ASSERT_SAME(tuning::noise::kPriorFrames, noise.correlation_frames());
  TEST_ASSERT_TRUE(noise.sigma_gate() > Scalar(0.15));
}

void test_noise_should_be_implausible_when_it_is_three_times_its_prior() {
  TEST_ASSERT_FALSE(learned(Scalar(0.3), 0).is_implausible());
  TEST_ASSERT_TRUE(learned(Scalar(0.6), 0).is_implausible());
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_noise_should_grow_to_the_residuals_when_they_are_larger_than_the_prior);
  RUN_TEST(test_correlation_should_be_found_when_errors_stay_with_their_features);
  RUN_TEST(test_noise_should_stay_at_the_prior_when_residuals_are_smaller);
  RUN_TEST(test_noise_should_hardly_follow_wrong_matches);
  RUN_TEST(test_correlation_should_stay_within_its_bounds);
  RUN_TEST(test_correlation_should_end_alike_when_its_prior_was_far_off);
  RUN_TEST(test_correlation_should_stay_at_its_prior_when_no_match_has_a_trace);
  RUN_TEST(test_noise_should_be_implausible_when_it_is_three_times_its_prior);
  return UNITY_END();
}
