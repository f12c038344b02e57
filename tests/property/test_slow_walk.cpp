// A walk that nothing tells the scale of leaves a covariance that is one, in float as in double.
#include "support/slow_walk.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr double kSmallest = -1e-4;   // eigenvalue of correlations
constexpr double kFloatError = 0.02;  // [m] after Sim(3), of a path of 7 m: six seeds gave 1.5 to 6.4 mm
constexpr double kDoubleError = 0.2;  // [m], where independent depth priors bend the scale (lib/docs/float.md)

void require_sound(const SlowWalk& walk) {
  TEST_ASSERT_TRUE(walk.smallest > kSmallest);
  TEST_ASSERT_EQUAL_INT(0, walk.starts);
  TEST_ASSERT_EQUAL_INT(0, walk.repairs);
  // The first has nothing to measure. Where the pose is hardly known, double has it in P, and waits for points to measure it against.
  TEST_ASSERT_TRUE(walk.tracked >= (GaugePrior::kInUse ? walk.frames - 1 : 95 * walk.frames / 100));
  TEST_ASSERT_TRUE(walk.error_m < (GaugePrior::kInUse ? kFloatError : kDoubleError));
}

void test_the_covariance_should_stay_one_without_a_scale() {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SlowWalk walk;
    walk.frames = 700;
    walk.run(seed);
    require_sound(walk);
  }
}

void test_the_covariance_should_stay_one_from_a_pose_that_is_hardly_known() {
  SlowWalk walk;
  walk.frames = 700;
  walk.pose_sigma = 0.1;
  walk.run(4);
  require_sound(walk);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_the_covariance_should_stay_one_without_a_scale);
  RUN_TEST(test_the_covariance_should_stay_one_from_a_pose_that_is_hardly_known);
  return UNITY_END();
}
