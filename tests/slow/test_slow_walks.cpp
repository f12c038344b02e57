// Many long walks that nothing tells the scale of: the covariance stays one, and nothing starts over. PLANEFOLD_WALKS: how many (10).
#include <algorithm>
#include <cstdlib>

#include "support/slow_walk.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

void test_the_covariance_should_stay_one_over_long_walks() {
  const char* const wanted = std::getenv("PLANEFOLD_WALKS");
  const int walks = wanted != nullptr ? std::atoi(wanted) : 10;
  std::vector<double> error;
  double smallest = 1;
  for (int seed = 1; seed <= walks; ++seed) {
    SlowWalk walk;
    walk.frames = 5000;
    walk.look_every = 50;
    walk.run(static_cast<std::uint64_t>(seed));
    smallest = std::min(smallest, walk.smallest);
    error.push_back(walk.error_m);
    TEST_ASSERT_TRUE(walk.smallest > -1e-4);
    TEST_ASSERT_EQUAL_INT(0, walk.starts);
    TEST_ASSERT_EQUAL_INT(walk.frames - 1, walk.tracked);
  }
  std::sort(error.begin(), error.end());
  std::printf("%d walks: smallest eigenvalue %.3g, median error %.2f mm\n", walks, smallest,
              1000 * error[error.size() / 2]);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_the_covariance_should_stay_one_over_long_walks);
  return UNITY_END();
}
