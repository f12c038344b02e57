// Lines of the log: texts, whole numbers and real ones, in a place of fixed size.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include "base/hooks.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

int lines;
char last_line[1000];

void keep_line(void*, const char* line) {
  ++lines;
  std::strncpy(last_line, line, sizeof(last_line) - 1);
}

template <class... Parts>
const char* logged(const Parts&... parts) {
  Hooks hooks;
  hooks.log = keep_line;
  hooks.say(parts...);
  return last_line;
}

void test_line_should_hold_texts_and_numbers_in_their_order() {
  TEST_ASSERT_EQUAL_STRING("plane 7: 3 of 25 points rejected, normal by 2.1 deg",
                           logged("plane ", std::uint32_t{7}, ": ", 3, " of ", 25, " points rejected, normal by ",
                                  degrees(0.0367f), " deg"));
  TEST_ASSERT_EQUAL_STRING("", logged(""));
}

void test_whole_numbers_should_be_written_up_to_the_ends_of_their_types() {
  TEST_ASSERT_EQUAL_STRING("0 -1 -9223372036854775808 9223372036854775807 4294967295",
                           logged(0, " ", -1, " ", INT64_MIN, " ", INT64_MAX, " ", UINT32_MAX));
}

void test_real_numbers_should_be_rounded_to_their_digits() {
  TEST_ASSERT_EQUAL_STRING("0.05 -1.50 2 1.000 0.007",
                           logged(fixed(0.0499, 2), " ", fixed(-1.5f, 2), " ", fixed(1.5, 0), " ", fixed(0.9996, 3),
                                  " ", fixed(0.00651, 3)));
  // A number that rounds to zero has no sign.
  TEST_ASSERT_EQUAL_STRING("0.0 0", logged(fixed(-0.04, 1), " ", fixed(-0.0, 0)));
  TEST_ASSERT_EQUAL_STRING("1.234567 3", logged(fixed(1.2345671, 99), " ", fixed(3.14, -5)));
}

void test_real_numbers_of_any_size_should_have_a_form() {
  TEST_ASSERT_EQUAL_STRING("999999999.5 1.0e9 -2.50e12",
                           logged(fixed(999999999.5, 1), " ", fixed(1e9, 1), " ", fixed(-2.5e12, 2)));
  const double inf = std::numeric_limits<double>::infinity();
  TEST_ASSERT_EQUAL_STRING("inf -inf nan", logged(fixed(inf, 1), " ", fixed(-inf, 1), " ", fixed(std::nan(""), 1)));
  TEST_ASSERT_EQUAL_STRING("0.0", logged(fixed(std::numeric_limits<double>::denorm_min(), 1)));
  TEST_ASSERT_NOT_NULL(std::strstr(logged(fixed(std::numeric_limits<double>::max(), 1)), "e308"));
}

void test_line_that_is_too_long_should_be_cut_off_visibly() {
  const std::string full(LogLine::kMaxLength, 'x'), longer = full + "x";
  TEST_ASSERT_EQUAL_STRING(full.c_str(), logged(full.c_str()));
  const std::string cut = full.substr(3) + "...";
  TEST_ASSERT_EQUAL_STRING(cut.c_str(), logged(longer.c_str()));
  TEST_ASSERT_EQUAL_STRING(cut.c_str(), logged(full.c_str(), 12345, fixed(1.5, 3), longer.c_str()));
}

void test_nothing_should_be_said_without_a_log() {
  lines = 0;
  Hooks().say("plane ", 7);
  TEST_ASSERT_EQUAL_INT(0, lines);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_line_should_hold_texts_and_numbers_in_their_order);
  RUN_TEST(test_whole_numbers_should_be_written_up_to_the_ends_of_their_types);
  RUN_TEST(test_real_numbers_should_be_rounded_to_their_digits);
  RUN_TEST(test_real_numbers_of_any_size_should_have_a_form);
  RUN_TEST(test_line_that_is_too_long_should_be_cut_off_visibly);
  RUN_TEST(test_nothing_should_be_said_without_a_log);
  return UNITY_END();
}
