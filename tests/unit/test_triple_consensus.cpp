// Consensus over triples: right matches speak for the pose that they give, matches at random places in the searched areas against it.
#include "filter_slam/pose/consensus.h"
#include "filter_slam/pose/triple_consensus.h"
#include "support/filter_scene.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kMatches = 30, kTriples = 40;
constexpr Scalar kGate = Scalar(9.2103);  // 99 % with two degrees of freedom
constexpr Scalar kEnough = Scalar(6.9);   // that one frame can say

/// A known map, a camera whose pose is hardly known, and matches of which every one beyond the first `right` is at a random place in
/// its own search ellipse.
struct Matches {
  TestFilter filter{true};
  PixelMeasurement match[kMatches];
  Scalar searched_px2[kMatches];

  /// sigma_px: what the gate allows a match, whose error is 0.5 px. sigma_pose: of the camera, in rad and m.
  Matches(SeededRandom& random, int right, Scalar sigma_px = 1, double sigma_pose = 0.03) {
    const std::vector<int> slots = fill_map(random, filter, kMatches, 0);
    Dense P = Dense::Identity(filter.dim(), filter.dim()) * 1e-8;
    P.block(Body::kTheta, Body::kTheta, 3, 3) = Dense::Identity(3, 3) * (sigma_pose * sigma_pose);
    P.block(Body::kPosition, Body::kPosition, 3, 3) = Dense::Identity(3, 3) * (sigma_pose * sigma_pose);
    filter.set_P(P);
    const Camera camera = pinhole_camera();
    Body truth = filter->state().body;
    truth.q_WC = exp_so3(random.normals<3>(sigma_pose)) * truth.q_WC;
    truth.p_W += random.normals<3>(sigma_pose);
    for (int i = 0; i < kMatches; ++i) {
      PixelMeasurement& o = match[i];
      TEST_ASSERT_TRUE(filter->predict_pixel(camera, slots[static_cast<std::size_t>(i)], &o));
      // Second-order errors of a rotation of 0.03 rad are about half a pixel.
      o.set_noise(sigma_px * sigma_px * Mat2::Identity());
      const Mat2 S = filter->innovation(o) + o.R_gate;
      searched_px2[i] = Scalar(3.14159265) * kGate * std::sqrt(S.determinant());
      Vec2 z;
      TEST_ASSERT_TRUE(project(
          camera, truth.q_WC.conjugate() * (filter->point(slots[static_cast<std::size_t>(i)]) - truth.p_W), &z));
      o.measured = i < right ? Vec2(z + random.normals<2>(0.5)) : anywhere(random, o, S);
    }
    filter->begin_update(match, kMatches);
  }

  static Vec2 anywhere(SeededRandom& random, const PixelMeasurement& o, const Mat2& S) {
    for (;;) {
      const Scalar size = Scalar(3.1) * std::sqrt(std::max(S(0, 0), S(1, 1)));
      const Vec2 r(size * static_cast<Scalar>(random.uniform(-1, 1)),
                   size * static_cast<Scalar>(random.uniform(-1, 1)));
      if (squared_distance(r, S) < kGate) return o.predicted + r;
    }
  }

  PoseConsensus find(int found, int attempts, unsigned char* keep) const {
    return find_triple_consensus(*filter, match, searched_px2, found, attempts, prior_share(), kGate, kTriples, keep);
  }
  Scalar evidence(int found, int attempts) const {
    unsigned char keep[kMatches];
    return evidence_against_chance(find(found, attempts, keep), prior_share());
  }
  static FindShare prior_share() {
    FindShare share;
    share.init();
    return share;
  }
};

void test_right_matches_should_speak_for_a_pose_also_when_half_are_wrong() {
  SeededRandom random(111);
  int far = 0, right_kept = 0, wrong_kept = 0;
  constexpr int kTrials = 40, kRight = kMatches / 2;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Matches m(random, kRight);
    unsigned char keep[kMatches];
    const PoseConsensus consensus = m.find(kMatches, kMatches, keep);
    far += evidence_against_chance(consensus, Matches::prior_share()) > kEnough && consensus.inliers >= 8 ? 1 : 0;
    int kept = 0;
    for (int i = 0; i < kMatches; ++i) {
      kept += keep[i];
      (i < kRight ? right_kept : wrong_kept) += keep[i];
    }
    TEST_ASSERT_EQUAL_INT(kept, consensus.inliers);
  }
  std::printf("enough %d of %d, kept %d of %d right and %d of %d wrong\n", far, kTrials, right_kept, kTrials * kRight,
              wrong_kept, kTrials * (kMatches - kRight));
  TEST_ASSERT_GREATER_OR_EQUAL_INT(kTrials - 1, far);
  TEST_ASSERT_TRUE(right_kept > 0.9 * kTrials * kRight);
  TEST_ASSERT_TRUE(wrong_kept < 0.05 * kTrials * (kMatches - kRight));
}

void test_random_matches_should_speak_against_it() {
  SeededRandom random(112);
  Scalar greatest = -1000;
  for (int trial = 0; trial < 200; ++trial)
    greatest = std::max(greatest, Matches(random, 0).evidence(kMatches, kMatches));
  std::printf("greatest evidence of 200: %.2f\n", static_cast<double>(greatest));
  TEST_ASSERT_TRUE(greatest < Scalar(0));
}

void test_close_matches_should_speak_for_it_although_most_searches_are_in_vain() {
  SeededRandom random(115);
  constexpr int kFound = 15, kAttempts = 42, kTrials = 40;
  constexpr Scalar kOpenPx = 3;        // of features whose depths are open
  constexpr double kFollowed = 0.003;  // after a tracked frame
  int close = 0, anywhere = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Matches right(random, kFound, kOpenPx, kFollowed), wrong(random, 0, kOpenPx, kFollowed);
    close += right.evidence(kFound, kAttempts) > Scalar(0) ? 1 : 0;
    anywhere += wrong.evidence(kFound, kAttempts) > Scalar(0) ? 1 : 0;
  }
  std::printf("for it: %d of %d close, %d of %d anywhere\n", close, kTrials, anywhere, kTrials);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(9 * kTrials / 10, close);
  TEST_ASSERT_EQUAL_INT(0, anywhere);
}

void test_the_same_inliers_should_say_less_when_more_was_searched_in_vain() {
  SeededRandom random(113);
  const Matches m(random, 20);
  TEST_ASSERT_TRUE(m.evidence(kMatches, 4 * kMatches) < m.evidence(kMatches, kMatches) - 1);
}

void test_fewer_than_four_matches_should_have_no_inliers() {
  SeededRandom random(114);
  const Matches m(random, kMatches);
  unsigned char keep[3] = {1, 1, 1};
  TEST_ASSERT_EQUAL_INT(0, m.find(3, 3, keep).inliers);
  for (const unsigned char k : keep) TEST_ASSERT_EQUAL_INT(0, k);
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_right_matches_should_speak_for_a_pose_also_when_half_are_wrong);
  RUN_TEST(test_random_matches_should_speak_against_it);
  RUN_TEST(test_close_matches_should_speak_for_it_although_most_searches_are_in_vain);
  RUN_TEST(test_the_same_inliers_should_say_less_when_more_was_searched_in_vain);
  RUN_TEST(test_fewer_than_four_matches_should_have_no_inliers);
  return UNITY_END();
}
