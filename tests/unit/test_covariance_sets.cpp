// Every tuned kernel set equals the reference, and itself at other addresses and in poisoned memory.
#include "covariance_equality.h"

namespace {

using covariance_cases::check_set;

constexpr int kRounds = 200;
constexpr std::uint64_t kSeed = 2008;

void check(std::uint32_t id) {
  check_set(id, kRounds, 80, kSeed);
  check_set(id, 5, 260, kSeed + 1);
}

void test_portable_should_equal_the_reference_when_blocks_are_random() { check(2); }
void test_avx2_should_equal_the_reference_when_blocks_are_random() { check(3); }
void test_avx512_should_equal_the_reference_when_blocks_are_random() { check(4); }
void test_neon_should_equal_the_reference_when_blocks_are_random() { check(5); }

void test_select_should_fall_back_to_a_set_that_runs_when_asked_for_the_fastest() {
  const pf::Kernels* kernels = pf::select_kernels(0);
  TEST_ASSERT_NOT_NULL(kernels);
  std::printf("fastest here: %s\n", covariance_cases::kSetNames[pf::kernels_id(kernels)]);
  TEST_ASSERT_TRUE(pf::kernels_id(kernels) >= 2);
}

void test_select_should_refuse_when_the_set_is_unknown() {
  TEST_ASSERT_NULL(pf::select_kernels(6));
  TEST_ASSERT_EQUAL_UINT32(0, pf::kernels_id(nullptr));
}

void test_cholesky_should_refuse_in_every_set_when_the_matrix_is_indefinite() {
  for (std::uint32_t id = 1; id <= 5; ++id) {
    const pf::Kernels* kernels = pf::select_kernels(id);
    if (kernels == nullptr) continue;
    for (int m = 1; m <= 40; ++m) {
      std::vector<pf::Scalar> S(static_cast<std::size_t>(m) * m, 0);
      for (int i = 0; i < m; ++i) S[i * m + i] = i == m - 1 ? pf::Scalar(-1) : pf::Scalar(2);
      TEST_ASSERT_FALSE(kernels->cholesky(S.data(), m, m));
    }
  }
}

}  // namespace

void setUp(void) {}
void tearDown(void) {}

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_portable_should_equal_the_reference_when_blocks_are_random);
  RUN_TEST(test_avx2_should_equal_the_reference_when_blocks_are_random);
  RUN_TEST(test_avx512_should_equal_the_reference_when_blocks_are_random);
  RUN_TEST(test_neon_should_equal_the_reference_when_blocks_are_random);
  RUN_TEST(test_select_should_fall_back_to_a_set_that_runs_when_asked_for_the_fastest);
  RUN_TEST(test_select_should_refuse_when_the_set_is_unknown);
  RUN_TEST(test_cholesky_should_refuse_in_every_set_when_the_matrix_is_indefinite);
  return UNITY_END();
}
