// Random windows through the bundle adjuster, degenerate ones among them: its cost never rises, and all stays finite.
#include "support/random_window.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

void test_cost_should_never_rise_and_all_stay_finite_in_random_windows() { check_random_windows(2, 10000); }

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_cost_should_never_rise_and_all_stay_finite_in_random_windows);
  return UNITY_END();
}
