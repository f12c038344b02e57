// A patch that does not tell the plane that it lies on, since the world's scale is hardly known, on rendered frames of one textured wall
// of which the plan has the left half: what is tried with it must not say where the world is.
#include <planefold/planefold_research.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "support/wall_walk.h"

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kFrames = 150, kPatches = 8, kDirections = 7;
constexpr double kRounding = 1e-6;  // of the information

void test_a_plane_that_is_not_founded_should_tell_nothing_of_the_gauge() {
  WallWalk run(kFrames, kPatches, 40);
  pf_wall_prior_t half = WallWalk::wall(0, 1.25);
  half.p_WP[0] = -1.3;
  half.covariance[0] = half.covariance[4] = 0.0025;
  half.covariance[8] = 0.09;
  run.add(half);
  double before[kDirections * kDirections] = {}, now[kDirections * kDirections], worst = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    run.step();
    pf_report_t report;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(run.slam, &report));
    const std::size_t n = static_cast<std::size_t>(report.state_dim);
    std::vector<double> scratch(n * (n + 8));
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_gauge_information(run.slam, scratch.data(), scratch.size(), now));
    for (int k = 0; k < 3 && frame > 1; ++k) {
      const double growth = now[(kDirections + 1) * k] / before[(kDirections + 1) * k] - 1;
      if (growth > kRounding)
        std::printf("frame %d: direction %d, %g grows by %g of itself\n", frame, k, now[(kDirections + 1) * k], growth);
      worst = std::max(worst, growth);
    }
    std::copy(now, now + kDirections * kDirections, before);
  }
  std::printf("grows by %g of itself at most\n", worst);
  TEST_ASSERT_TRUE(worst < kRounding);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_a_plane_that_is_not_founded_should_tell_nothing_of_the_gauge);
  return UNITY_END();
}
