// Times: spans that do not fit in 64 bits of nanoseconds.
#include <cstdint>

#include "base/elapsed.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

void test_elapsed_should_stop_at_the_largest_span() {
  TEST_ASSERT_EQUAL_INT64(7, elapsed_ns(-3, 4));
  TEST_ASSERT_EQUAL_INT64(INT64_MAX, elapsed_ns(INT64_MIN, INT64_MAX));
}

void test_nanoseconds_should_keep_their_sign_however_long() {
  TEST_ASSERT_EQUAL_INT64(-1500000000, nanoseconds(-1.5));
  for (const double s : {1e10, 1e300}) {
    TEST_ASSERT_TRUE(nanoseconds(s) > INT64_MAX / 100 * 99);
    TEST_ASSERT_TRUE(nanoseconds(-s) < INT64_MIN / 100 * 99);
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_elapsed_should_stop_at_the_largest_span);
  RUN_TEST(test_nanoseconds_should_keep_their_sign_however_long);
  return UNITY_END();
}
