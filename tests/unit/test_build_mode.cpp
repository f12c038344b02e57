// Each preset with a special mode is really in that mode: the folder's name says which one was asked for, and the
// compiler and a deliberate fault in a child process say which one is on.
#include <sys/wait.h>
#include <unistd.h>

#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>

#include "base/arena.h"
#include "base/scalar.h"
#include "unity.h"

extern "C" void __gcov_init(void) __attribute__((weak));

void setUp(void) {}
void tearDown(void) {}

namespace {

std::string preset() {
  const char* build = std::getenv("PLANEFOLD_BUILD");
  const std::string path = build != nullptr ? build : "";
  return path.substr(path.find_last_of('/') + 1);
}

bool asan_is_compiled_in() {
#if defined(__SANITIZE_ADDRESS__)
  return true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
  return true;
#endif
#endif
  return false;
}

bool tsan_is_compiled_in() {
#if defined(__SANITIZE_THREAD__)
  return true;
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
  return true;
#endif
#endif
  return false;
}

/// True when a child process that runs the fault does not end well. What the child says is thrown away.
template <class Fault>
bool child_is_stopped(Fault fault) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    if (std::freopen("/dev/null", "w", stderr) == nullptr) _exit(0);
    fault();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status != 0;
}

void read_past_the_end() {
  char* volatile bytes = static_cast<char*>(std::malloc(16));
  volatile char taken = bytes[16];
  (void)taken;
  std::free(bytes);
}

void write_into_a_red_zone() {
  alignas(pf::Arena::kAlignment) static unsigned char block[1024];
  pf::Arena arena(block, sizeof block);
  volatile unsigned char* const piece = arena.take<unsigned char>(1);
  piece[pf::Arena::kAlignment] = 1;
}

void overflow_an_int() {
  volatile int largest = INT_MAX;
  volatile int sum = largest + 1;
  (void)sum;
}

void race_on_an_int() {
  static int counter = 0;
  auto count = [] {
    for (int i = 0; i < 1000; ++i) {
      counter = counter + 1;
      std::this_thread::yield();
    }
  };
  std::thread one(count), two(count);
  one.join();
  two.join();
  std::exit(0);  // the thread sanitizer changes the status at exit
}

void test_address_sanitizer_should_stop_a_bad_read_when_the_preset_asks_for_it() {
  const bool wanted = preset() == "asan-ubsan";
  TEST_ASSERT_EQUAL_INT(wanted, asan_is_compiled_in());
  if (wanted) TEST_ASSERT_TRUE(child_is_stopped(read_past_the_end));
}

void test_an_arena_should_have_red_zones_under_the_address_sanitizer_of_any_compiler() {
  TEST_ASSERT_EQUAL_INT(asan_is_compiled_in(), child_is_stopped(write_into_a_red_zone));
}

void test_undefined_sanitizer_should_stop_an_overflow_when_the_preset_asks_for_it() {
  TEST_ASSERT_EQUAL_INT(preset() == "asan-ubsan", child_is_stopped(overflow_an_int));
}

void test_thread_sanitizer_should_report_a_race_when_the_preset_asks_for_it() {
  const bool wanted = preset() == "tsan";
  TEST_ASSERT_EQUAL_INT(wanted, tsan_is_compiled_in());
  if (wanted) TEST_ASSERT_TRUE(child_is_stopped(race_on_an_int));
}

void test_coverage_should_be_counted_when_the_preset_asks_for_it() {
  TEST_ASSERT_EQUAL_INT(preset() == "coverage", __gcov_init != nullptr);
}

void test_scalar_should_be_float_when_the_float_library_is_linked() {
#if defined(PLANEFOLD_SCALAR_FLOAT)
  TEST_ASSERT_EQUAL_size_t(4, sizeof(pf::Scalar));
#else
  TEST_ASSERT_EQUAL_size_t(8, sizeof(pf::Scalar));
  TEST_ASSERT_FALSE(preset() == "float");
#endif
}

void test_assertions_should_be_off_when_the_preset_is_for_release() {
#if defined(NDEBUG)
  TEST_ASSERT_FALSE(preset() == "debug" || preset() == "coverage");
#else
  TEST_ASSERT_FALSE(preset() == "release" || preset() == "float");
#endif
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_address_sanitizer_should_stop_a_bad_read_when_the_preset_asks_for_it);
  RUN_TEST(test_an_arena_should_have_red_zones_under_the_address_sanitizer_of_any_compiler);
  RUN_TEST(test_undefined_sanitizer_should_stop_an_overflow_when_the_preset_asks_for_it);
  RUN_TEST(test_thread_sanitizer_should_report_a_race_when_the_preset_asks_for_it);
  RUN_TEST(test_coverage_should_be_counted_when_the_preset_asks_for_it);
  RUN_TEST(test_scalar_should_be_float_when_the_float_library_is_linked);
  RUN_TEST(test_assertions_should_be_off_when_the_preset_is_for_release);
  return UNITY_END();
}
