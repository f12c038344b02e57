// Hypotheses of a frame's pose: what a part of a frame must say before it may move the estimate, how several share the odds, and where the
// camera is looked for when it is not where it was predicted.
#include <algorithm>
#include <cmath>

#include "belief/tuning.h"
#include "frame/pose_hypotheses.h"
#include "frame/tuning.h"
#include "support/seeded_random.h"
#include "support/test_cameras.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

/// A frame's consensus of so many inliers, each of which says much.
PoseConsensus consensus_of(int inliers, Scalar of_each) {
  PoseConsensus consensus;
  consensus.searched = consensus.inliers = inliers;
  consensus.log_density = static_cast<Scalar>(inliers) * of_each;
  return consensus;
}

struct Bench {
  Settings settings;
  PoseBelief belief;
  PoseHypotheses hypotheses{settings, belief};

  Bench() {
    settings.min_inliers = 8;
    hypotheses.begin();
  }
};

}  // namespace

/// Whatever the rest of the frame says, a pose that its first part has moved the estimate to stays believed; and of what is not accepted,
/// something can take the belief away.
void test_part_of_a_frame_should_move_the_estimate_only_when_the_rest_cannot_contradict_it() {
  Bench bench;
  SeededRandom random(511);
  int accepted = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const Scalar log_odds = static_cast<Scalar>(random.uniform(-14, 14));
    const bool accepts = bench.hypotheses.accepts(consensus_of(12, 1), log_odds, false);
    Scalar least = log_odds;
    for (int k = 0; k < 20; ++k)
      least = std::min(least, PoseBelief::updated(log_odds, static_cast<Scalar>(random.uniform(-100, 100))));
    least = std::min(least, PoseBelief::updated(log_odds, Scalar(-1e6)));
    TEST_ASSERT_EQUAL_INT(accepts ? 1 : 0, PoseBelief::is_enough(least) ? 1 : 0);
    accepted += accepts ? 1 : 0;
  }
  TEST_ASSERT_TRUE(accepted > 0);
}

void test_whole_frame_should_move_the_estimate_when_the_pose_is_believed_by_enough_inliers() {
  Bench bench;
  const Scalar enough = tuning::pose_belief::kTracked;
  TEST_ASSERT_TRUE(bench.hypotheses.accepts(consensus_of(8, 1), enough));
  TEST_ASSERT_FALSE(bench.hypotheses.accepts(consensus_of(8, 1), enough, false));
  TEST_ASSERT_FALSE(bench.hypotheses.accepts(consensus_of(8, 1), enough - Scalar(0.01)));
  TEST_ASSERT_FALSE(bench.hypotheses.accepts(consensus_of(7, 1), PoseBelief::most()));
  TEST_ASSERT_FALSE(bench.hypotheses.accepts(consensus_of(7, 1), PoseBelief::most(), false));
}

void test_each_hypothesis_should_have_its_share_of_the_odds_when_several_are_tried() {
  Bench bench;
  const PoseConsensus consensus = consensus_of(10, Scalar(0.3));
  const Scalar one = bench.hypotheses.evidence(consensus);
  bench.hypotheses.add();
  TEST_ASSERT_FLOAT_WITHIN(1e-5, static_cast<float>(std::log(2.0)),
                           static_cast<float>(one - bench.hypotheses.evidence(consensus)));
  bench.hypotheses.add();
  TEST_ASSERT_FLOAT_WITHIN(1e-5, static_cast<float>(std::log(3.0)),
                           static_cast<float>(one - bench.hypotheses.evidence(consensus)));
  bench.hypotheses.begin();
  TEST_ASSERT_TRUE(one == bench.hypotheses.evidence(consensus));
}

void test_lost_camera_should_be_looked_for_where_the_last_frame_proposes() {
  const ViewMemory views;
  const Pyramid image{};
  PoseHypothesis found;
  PoseProposal last;
  TEST_ASSERT_FALSE(find_elsewhere(last, views, image, pinhole_camera(), 1, &found));
  last = {true, 3, Quat(Scalar(0.6), 0, Scalar(0.8), 0), Vec3(1, 2, 3), Scalar(2.5)};
  TEST_ASSERT_TRUE(find_elsewhere(last, views, image, pinhole_camera(), 1, &found));
  TEST_ASSERT_TRUE(found.p_W == last.p_W && found.q_WC.coeffs() == last.q_WC.coeffs());
  const Scalar turn = tuning::relocaliser::kAboutProposal, shift = turn * last.depth;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      const Scalar expected = i != j ? Scalar(0) : i < 3 ? turn * turn : shift * shift;
      TEST_ASSERT_FLOAT_WITHIN(1e-7, static_cast<float>(expected), static_cast<float>(found.P(i, j)));
    }
}

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_part_of_a_frame_should_move_the_estimate_only_when_the_rest_cannot_contradict_it);
  RUN_TEST(test_whole_frame_should_move_the_estimate_when_the_pose_is_believed_by_enough_inliers);
  RUN_TEST(test_each_hypothesis_should_have_its_share_of_the_odds_when_several_are_tried);
  RUN_TEST(test_lost_camera_should_be_looked_for_where_the_last_frame_proposes);
  return UNITY_END();
}
