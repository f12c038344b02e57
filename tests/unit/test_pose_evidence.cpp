// What one frame says for a pose: right matches for it, chance against it, and how much misses count.
#include <cmath>

#include "belief/pose_evidence.h"
#include "belief/tuning.h"
#include "support/seeded_random.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr Scalar kGate = Scalar(9.2103);
constexpr Scalar kPi = Scalar(3.14159265358979);

/// `inliers` matches of `searched` features with independent residuals of standard deviation s: as the model says, or anywhere in the gate.
PoseConsensus consensus_of(SeededRandom& random, int searched, int inliers, Scalar s, bool anywhere) {
  PoseConsensus c;
  c.searched = searched;
  c.inliers = inliers;
  for (int i = 0; i < inliers; ++i) {
    Vec2 r = random.normals<2>(1);
    if (anywhere) {
      do r << static_cast<Scalar>(random.uniform(-1, 1)), static_cast<Scalar>(random.uniform(-1, 1));
      while (r.squaredNorm() > 1);
      r *= std::sqrt(kGate);
    }
    c.log_density += log_normal_density(r.squaredNorm(), 4 * std::log(s), 1);
    c.log_chance += log_chance_density(kPi * kGate * s * s);
  }
  return c;
}

void test_normal_density_should_be_that_of_its_integral() {
  Scalar sum = 0;
  const Scalar step = Scalar(0.05), s = 2;
  for (Scalar x = -12; x < 12; x += step)
    for (Scalar y = -12; y < 12; y += step)
      sum += step * step * std::exp(log_normal_density((x * x + y * y) / (s * s), 4 * std::log(s), 1));
  TEST_ASSERT_DOUBLE_WITHIN(1e-4, static_cast<double>(1), static_cast<double>(sum));
}

void test_chance_should_be_bounded_in_small_areas() {
  using namespace tuning::chance;
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, static_cast<double>(kMaxFindShare / kMinArea),
                            static_cast<double>(std::exp(log_chance_density(1))));
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, static_cast<double>(kMaxFindShare / 5000),
                            static_cast<double>(std::exp(log_chance_density(5000))));
}

void test_probability_of_all_shares_should_sum_to_one() {
  FindShare share;
  share.init();
  constexpr int kSearched = 12;
  for (const Scalar as_sharp : {Scalar(1), Scalar(0.3)}) {
    share.begin_frame(as_sharp);
    Scalar sum = 0, ways = 1;
    for (int k = 0; k <= kSearched; ++k) {
      sum += ways * std::exp(share.log_probability(kSearched, k));
      ways *= static_cast<Scalar>(kSearched - k) / static_cast<Scalar>(k + 1);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, static_cast<double>(1), static_cast<double>(sum));
  }
}

/// In ellipses as wide as those of features whose depths are open, so that all that is found passes their gates.
void test_right_matches_should_speak_for_a_pose_and_chance_against_it() {
  SeededRandom random(301);
  FindShare share;
  share.init();
  int right = 0;
  for (int trial = 0; trial < 100; ++trial) {
    right += pose_evidence(consensus_of(random, 33, 20, 15, false), share, AlikeShare()) > Scalar(3) ? 1 : 0;
    TEST_ASSERT_TRUE(pose_evidence(consensus_of(random, 33, 8, 15, true), share, AlikeShare()) < Scalar(-3));
  }
  TEST_ASSERT_GREATER_OR_EQUAL_INT(97, right);
}

void test_misses_should_say_less_once_frames_have_missed_much() {
  FindShare sharp, smeared;
  sharp.init();
  smeared.init();
  for (int frame = 0; frame < 10; ++frame) {
    sharp.learn(40, 34);
    smeared.learn(40, 8);
  }
  PoseConsensus none;
  none.searched = 30;
  TEST_ASSERT_TRUE(pose_evidence(none, sharp, AlikeShare()) < pose_evidence(none, smeared, AlikeShare()) - 3);
  const FindShare before = sharp;
  sharp.learn(0, 0);  // a frame without a search says nothing of it
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, static_cast<double>(pose_evidence(none, before, AlikeShare())),
                            static_cast<double>(pose_evidence(none, sharp, AlikeShare())));
}

void test_few_of_many_should_be_unlikely_where_frames_have_found_most() {
  FindShare sharp, smeared;
  sharp.init();
  smeared.init();
  for (int frame = 0; frame < 20; ++frame) {
    sharp.learn(45, 42);
    smeared.learn(45, 10);
  }
  for (FindShare* share : {&sharp, &smeared})
    share->begin_frame(Scalar(0.5));  // whether this image is as sharp as those or not
  TEST_ASSERT_TRUE(sharp.is_unlikely(45, 8));
  TEST_ASSERT_FALSE(sharp.is_unlikely(45, 40));
  TEST_ASSERT_FALSE(sharp.is_unlikely(45, 45));
  TEST_ASSERT_FALSE(smeared.is_unlikely(45, 8));
}

/// In ellipses so wide that chance explains nothing of what agrees: what is left is a place that looks like the right one in a few points.
void test_few_of_many_should_be_another_place_however_well_they_agree() {
  SeededRandom random(302);
  FindShare share, smeared;
  share.init();
  smeared.init();
  for (int frame = 0; frame < 20; ++frame) {
    share.learn(200, 190);
    smeared.learn(200, 12);
  }
  constexpr Scalar kWide = 15;
  const PoseConsensus few = consensus_of(random, 200, 10, kWide, false);
  PoseConsensus exact = few;  // they agree to a pixel
  exact.log_density = 10 * log_normal_density(2, 0, 1);
  TEST_ASSERT_TRUE(evidence_against_chance(exact, smeared) > 20);
  TEST_ASSERT_TRUE(pose_evidence(exact, share, AlikeShare()) < -2);
  TEST_ASSERT_TRUE(pose_evidence(exact, smeared, AlikeShare()) > 6);  // of a smeared film ten are many
  PoseConsensus most = consensus_of(random, 200, 190, kWide, false);
  most.log_density = 190 * log_normal_density(2, 0, 1);
  TEST_ASSERT_TRUE(pose_evidence(most, share, AlikeShare()) > tuning::pose_belief::kMaxFrame);
}

void test_alike_views_should_take_from_what_agrees() {
  AlikeShare alike;
  alike.init();
  TEST_ASSERT_DOUBLE_WITHIN(1e-5, -6.9, static_cast<double>(alike.log_share()));
  for (int view = 0; view < 9; ++view) alike.note(false);
  TEST_ASSERT_DOUBLE_WITHIN(1e-5, -6.9, static_cast<double>(alike.log_share()));
  for (int view = 0; view < 10; ++view) alike.note(true);
  const double least = std::exp(-6.9);
  TEST_ASSERT_DOUBLE_WITHIN(1e-5, std::log(least + (1 - least) * 0.5), static_cast<double>(alike.log_share()));
  FindShare share;
  share.init();
  PoseConsensus all;
  all.searched = all.inliers = 40;
  all.log_density = 40 * log_normal_density(2, 0, 1);
  all.log_chance = 40 * log_chance_density(20000);
  TEST_ASSERT_TRUE(pose_evidence(all, share, AlikeShare()) > 6);
  TEST_ASSERT_TRUE(pose_evidence(all, share, alike) < 4);
  TEST_ASSERT_TRUE(pose_evidence(all, share, alike) > 0);
}

/// Where all points in view are searched for, a tenth of them is what wrong places have in common with the right one; in a less sharp image
/// it is as likely to be all that is left of the right one.
void test_a_common_part_should_speak_against_a_pose_in_sharp_images_only() {
  SeededRandom random(303);
  FindShare share;
  share.init();
  for (int frame = 0; frame < 20; ++frame) share.learn(200, 160);
  PoseConsensus few = consensus_of(random, 150, 17, 15, false);
  few.log_density = 17 * log_normal_density(2, 0, 1);
  TEST_ASSERT_TRUE(pose_evidence(few, share, AlikeShare()) < -3);
  share.begin_frame(Scalar(0.01));
  TEST_ASSERT_DOUBLE_WITHIN(0.3, 0.0, static_cast<double>(pose_evidence(few, share, AlikeShare())));
  share.begin_frame(1);
  few.is_elsewhere = true;  // how much is found from there is open as well
  TEST_ASSERT_DOUBLE_WITHIN(0.3, 0.0, static_cast<double>(pose_evidence(few, share, AlikeShare())));
  PoseConsensus most = consensus_of(random, 150, 100, 15, false);
  most.log_density = 100 * log_normal_density(2, 0, 1);
  TEST_ASSERT_TRUE(pose_evidence(most, share, AlikeShare()) > 5);
}

void test_shares_elsewhere_should_sum_to_their_probabilities() {
  PoseConsensus consensus;
  consensus.searched = 12;
  FindShare share;
  share.init();
  AlikeShare alike;
  alike.init();
  alike.note(true);
  Scalar sum = 0, ways = 1;
  for (int k = 0; k <= consensus.searched; ++k) {
    consensus.inliers = k;
    sum += ways * std::exp(log_share_elsewhere(consensus, share, alike));
    ways *= static_cast<Scalar>(consensus.searched - k) / static_cast<Scalar>(k + 1);
  }
  const Scalar expected = std::exp(alike.log_share()) + tuning::common_part::kShare;
  TEST_ASSERT_DOUBLE_WITHIN(1e-5, static_cast<double>(expected), static_cast<double>(sum));
}

/// A tenth of the features, of which as many have a neighbour as chance has it, or all.
void test_a_part_that_is_found_whole_should_speak_against_a_pose() {
  SeededRandom random(304);
  FindShare share;
  share.init();
  for (int frame = 0; frame < 20; ++frame) share.learn(200, 160);
  PoseConsensus few = consensus_of(random, 150, 17, 15, false);
  few.log_density = 17 * log_normal_density(2, 0, 1);
  few.is_elsewhere = true;
  const Scalar unknown = pose_evidence(few, share, AlikeShare());
  few.paired = 2;
  TEST_ASSERT_TRUE(pose_evidence(few, share, AlikeShare()) > unknown + 1);
  few.paired = 16;
  TEST_ASSERT_TRUE(pose_evidence(few, share, AlikeShare()) < unknown - 4);
  PoseConsensus most = consensus_of(random, 150, 100, 15, false);
  most.log_density = 100 * log_normal_density(2, 0, 1);
  const Scalar usual = pose_evidence(most, share, AlikeShare());
  most.paired = 85;
  TEST_ASSERT_DOUBLE_WITHIN(0.1, static_cast<double>(usual),
                            static_cast<double>(pose_evidence(most, share, AlikeShare())));
}

/// Any share of n: the sum over the ways to find k, and over k.
void test_any_share_should_sum_to_one() {
  constexpr int kSearched = 12;
  Scalar sum = 0, ways = 1;
  for (int k = 0; k <= kSearched; ++k) {
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1.0 / (kSearched + 1),
                              static_cast<double>(ways * std::exp(log_any_share(kSearched, k))));
    sum += ways * std::exp(log_any_share(kSearched, k));
    ways *= static_cast<Scalar>(kSearched - k) / static_cast<Scalar>(k + 1);
  }
  TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1.0, static_cast<double>(sum));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_normal_density_should_be_that_of_its_integral);
  RUN_TEST(test_chance_should_be_bounded_in_small_areas);
  RUN_TEST(test_probability_of_all_shares_should_sum_to_one);
  RUN_TEST(test_right_matches_should_speak_for_a_pose_and_chance_against_it);
  RUN_TEST(test_misses_should_say_less_once_frames_have_missed_much);
  RUN_TEST(test_few_of_many_should_be_unlikely_where_frames_have_found_most);
  RUN_TEST(test_few_of_many_should_be_another_place_however_well_they_agree);
  RUN_TEST(test_alike_views_should_take_from_what_agrees);
  RUN_TEST(test_a_common_part_should_speak_against_a_pose_in_sharp_images_only);
  RUN_TEST(test_shares_elsewhere_should_sum_to_their_probabilities);
  RUN_TEST(test_a_part_that_is_found_whole_should_speak_against_a_pose);
  RUN_TEST(test_any_share_should_sum_to_one);
  return UNITY_END();
}
