// Every tuned kernel set equals the reference over 10,000 random updates and moves with random block structures.
#include "covariance_equality.h"

namespace {

using covariance_cases::check_set;

constexpr int kRounds = 10000;
constexpr std::uint64_t kSeed = 2015;

void test_portable_should_equal_the_reference_over_many_updates() { check_set(2, kRounds, 120, kSeed); }
void test_avx2_should_equal_the_reference_over_many_updates() { check_set(3, kRounds, 120, kSeed); }
void test_avx512_should_equal_the_reference_over_many_updates() { check_set(4, kRounds, 120, kSeed); }
void test_neon_should_equal_the_reference_over_many_updates() { check_set(5, kRounds, 120, kSeed); }

}  // namespace

void setUp(void) {}
void tearDown(void) {}

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_portable_should_equal_the_reference_over_many_updates);
  RUN_TEST(test_avx2_should_equal_the_reference_over_many_updates);
  RUN_TEST(test_avx512_should_equal_the_reference_over_many_updates);
  RUN_TEST(test_neon_should_equal_the_reference_over_many_updates);
  return UNITY_END();
}
