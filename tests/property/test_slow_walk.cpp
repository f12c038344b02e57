// A walk that nothing tells the scale of leaves a covariance that is one, in float as in double.
#include "support/slow_walk.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr double kSmallest = -1e-4;  // eigenvalue of correlations
constexpr double kMaxError = 0.02;   // [m] after Sim(3), of a path of 7 m: six seeds gave 1.5 to 6.4 mm in float

void require_sound(const SlowWalk& walk) {
  TEST_ASSERT_TRUE(walk.smallest > kSmallest);
  TEST_ASSERT_EQUAL_INT(0, walk.starts);
  TEST_ASSERT_EQUAL_INT(0, walk.repairs);
  TEST_ASSERT_TRUE(walk.tracked >= walk.frames - 1);  // the first has nothing to measure
  TEST_ASSERT_TRUE(walk.error_m < kMaxError);
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
