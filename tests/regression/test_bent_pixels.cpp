// Pixels of a pose so wide that they are taken in twice, linearised again: what float makes of their noise and of the map's covariance
// (lib/docs/theory/float.md).
#include <unity.h>

#include "../fuzz/contract_episode.h"
#include "filter/measurement.h"
#include "same.h"

void setUp(void) {}
void tearDown(void) {}

namespace {

void test_noise_without_bend_should_not_depend_on_bend() {
  pf::PixelMeasurement z;
  z.bend = pf::Scalar(2.2e5);
  const pf::Mat2 R = (pf::Mat2() << 0.09, 0.01, 0.01, 0.3).finished().cast<pf::Scalar>();
  z.set_noises(R, 7 * R);
  TEST_ASSERT_SAME(pf::Mat2(7 * R), z.R_straight);
  TEST_ASSERT_TRUE(z.R_gate(0, 0) >= z.bend && z.R_update(1, 1) >= z.bend + 2);
  TEST_ASSERT_SAME(R(0, 1), z.R_gate(0, 1));
}

/// Float told the first one its pixels as exact, and then all at once, to a pose that these know 1e7 times better: a feature's smallest
/// eigenvalue was -0.0066. The second had -0.0077.
void test_maps_found_again_from_far_should_keep_their_covariance() {
  ContractRun::Seen seen{};
  play_episode(455001, 129, &seen);
  play_episode(455004, 40, &seen);
  TEST_ASSERT_GREATER_THAN_INT(400, seen.frames);
  TEST_ASSERT_GREATER_THAN_INT(190, seen.tracked);
  TEST_ASSERT_EQUAL_INT(0, seen.repaired);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_noise_without_bend_should_not_depend_on_bend);
  RUN_TEST(test_maps_found_again_from_far_should_keep_their_covariance);
  return UNITY_END();
}
