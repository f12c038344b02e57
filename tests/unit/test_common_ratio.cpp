// The ratio that most have in common: its median, its votes, and the best of the others.
#include "geometry/common_ratio.h"
#include "same.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

void test_the_ratio_of_most_should_be_found_in_any_order() {
  Scalar ratios[] = {Scalar(1.6), Scalar(1.01), Scalar(0.5), Scalar(1.02), Scalar(1.62), Scalar(1.00), Scalar(1.03)};
  const CommonRatio common = find_common_ratio(ratios, 7, Scalar(1.06));
  TEST_ASSERT_EQUAL_INT(4, common.votes);
  TEST_ASSERT_EQUAL_INT(2, common.others);
  TEST_ASSERT_SAME(Scalar(1.02), common.ratio);
}

void test_the_others_should_not_share_votes_with_most() {
  Scalar ratios[] = {Scalar(0.97), Scalar(1.00), Scalar(1.02), Scalar(1.04), Scalar(1.08)};
  const CommonRatio common = find_common_ratio(ratios, 5, Scalar(1.06));
  TEST_ASSERT_EQUAL_INT(3, common.votes);
  TEST_ASSERT_EQUAL_INT(2, common.others);
}

void test_no_ratios_should_have_nothing_in_common() {
  const CommonRatio common = find_common_ratio(nullptr, 0, Scalar(1.06));
  TEST_ASSERT_EQUAL_INT(0, common.votes);
  TEST_ASSERT_SAME(Scalar(0), common.ratio);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_the_ratio_of_most_should_be_found_in_any_order);
  RUN_TEST(test_the_others_should_not_share_votes_with_most);
  RUN_TEST(test_no_ratios_should_have_nothing_in_common);
  return UNITY_END();
}
