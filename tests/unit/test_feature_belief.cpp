#include <cmath>

#include "belief/feature_belief.h"
#include "belief/pose_evidence.h"
#include "belief/tuning.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

/// Searches in vain until a feature with these log-odds is no point of the scene.
int searches_in_vain(Scalar log_odds, Scalar share) {
  int n = 0;
  for (; n < 1000 && !is_no_point(log_odds); ++n) log_odds = updated_feature(log_odds, feature_evidence(false, share));
  return n;
}

void test_evidence_should_be_the_ratio_of_the_two_chances() {
  TEST_ASSERT_FLOAT_WITHIN(1e-5f, std::log(0.75f / 0.25f), static_cast<float>(feature_evidence(true, Scalar(0.75))));
  TEST_ASSERT_FLOAT_WITHIN(1e-5f, std::log(0.25f / 0.75f), static_cast<float>(feature_evidence(false, Scalar(0.75))));
}

void test_picture_in_which_next_to_nothing_is_found_should_say_nothing() {
  TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0, static_cast<float>(feature_evidence(false, Scalar(0.05))));
  TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0, static_cast<float>(feature_evidence(true, Scalar(0.05))));
}

void test_evidence_should_be_finite_where_everything_is_found() {
  TEST_ASSERT_TRUE(std::isfinite(feature_evidence(false, Scalar(1))));
}

void test_new_feature_should_go_after_a_few_searches_in_vain_and_a_proven_one_after_a_dozen() {
  TEST_ASSERT_INT_WITHIN(1, 5, searches_in_vain(Scalar(0), Scalar(0.7)));
  Scalar proven = 0;
  for (int i = 0; i < 1000; ++i) proven = updated_feature(proven, feature_evidence(true, Scalar(0.7)));
  TEST_ASSERT_INT_WITHIN(2, 12, searches_in_vain(proven, Scalar(0.7)));
}

void test_feature_that_is_found_as_often_as_chance_finds_it_should_go() {
  Scalar log_odds = 0;
  int n = 0;
  for (; n < 200 && !is_no_point(log_odds); ++n)
    log_odds = updated_feature(log_odds, feature_evidence(n % 4 == 3, Scalar(0.8)));
  TEST_ASSERT_LESS_THAN_INT(20, n);
}

void test_feature_that_is_found_as_often_as_the_others_should_stay() {
  Scalar log_odds = 0;
  for (int n = 0; n < 1000; ++n) {
    log_odds = updated_feature(log_odds, feature_evidence(n % 5 != 4, Scalar(0.8)));
    TEST_ASSERT_FALSE(is_no_point(log_odds));
  }
}

void test_share_of_a_frame_should_lie_between_the_mean_and_what_it_found() {
  FindShare mean;
  mean.init();
  TEST_ASSERT_FLOAT_WITHIN(1e-6f, static_cast<float>(tuning::find_share::kPrior),
                           static_cast<float>(mean.in_frame(0, 0)));
  const Scalar smeared = mean.in_frame(20, 1);
  TEST_ASSERT_TRUE(smeared > Scalar(0.05) && smeared < tuning::find_share::kPrior);
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_evidence_should_be_the_ratio_of_the_two_chances);
  RUN_TEST(test_picture_in_which_next_to_nothing_is_found_should_say_nothing);
  RUN_TEST(test_evidence_should_be_finite_where_everything_is_found);
  RUN_TEST(test_new_feature_should_go_after_a_few_searches_in_vain_and_a_proven_one_after_a_dozen);
  RUN_TEST(test_feature_that_is_found_as_often_as_chance_finds_it_should_go);
  RUN_TEST(test_feature_that_is_found_as_often_as_the_others_should_stay);
  RUN_TEST(test_share_of_a_frame_should_lie_between_the_mean_and_what_it_found);
  return UNITY_END();
}
