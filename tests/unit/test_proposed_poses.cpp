// Poses that frames in a row propose: which of them a hand can have moved the camera between, and when the row begins anew.
#include <cmath>

#include "filter_slam/pose/proposed_poses.h"
#include "support/filter_cases.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr std::int64_t kFrameNs = 33333333;
constexpr Scalar kDepth = 2;
constexpr Scalar kBefore = -10, kFor = 3;

struct Bench {
  SeededRandom random{19};
  Settings settings;
  TestFilter filter{true};
  ProposedPoses proposals{settings, *filter};
  Quat q_WC = random_turn(random, 1);
  Vec3 p_W = random.normals<3>(1);

  /// Frames in a row whose evidence the proposal has, from its log-odds.
  int propose_turned(Scalar rad, Scalar shift = 0, Scalar depth = kDepth) {
    proposals.begin_frame(kFrameNs);
    q_WC = exp_so3(Vec3(Scalar(0.6) * rad, Scalar(-0.8) * rad, 0)) * q_WC;
    p_W += Vec3(0, shift, 0);
    return propose(depth);
  }
  int propose(Scalar depth = kDepth) {
    return static_cast<int>(std::lround((proposals.propose(q_WC, p_W, depth, kBefore, kFor) - kBefore) / kFor));
  }
};

void test_proposals_that_a_hand_leads_to_should_add_up() {
  Bench bench;
  for (int frame = 1; frame <= 5; ++frame)
    TEST_ASSERT_EQUAL_INT(frame, bench.propose_turned(Scalar(0.02), Scalar(0.02)));
}

void test_a_jump_should_begin_anew() {
  Bench turned, shifted;
  turned.propose_turned(0);
  shifted.propose_turned(0);
  TEST_ASSERT_EQUAL_INT(1, turned.propose_turned(Scalar(0.5)));
  TEST_ASSERT_EQUAL_INT(2, turned.propose_turned(Scalar(0.02)));
  TEST_ASSERT_EQUAL_INT(1, shifted.propose_turned(0, kDepth));
  TEST_ASSERT_EQUAL_INT(2, shifted.propose_turned(0, Scalar(0.02)));
}

void test_a_jump_should_take_what_the_prediction_was_worth() {
  Bench bench;
  bench.propose_turned(0);
  bench.proposals.begin_frame(kFrameNs);
  bench.p_W += Vec3(0, kDepth, 0);
  const Scalar log_odds = bench.proposals.propose(bench.q_WC, bench.p_W, kDepth, 5, kFor);
  TEST_ASSERT_DOUBLE_WITHIN(1e-6, static_cast<double>(PoseBelief::anew() + kFor), static_cast<double>(log_odds));
}

void test_a_frame_that_proposes_nothing_should_end_the_row() {
  Bench bench;
  bench.propose_turned(0);
  bench.proposals.begin_frame(kFrameNs);
  TEST_ASSERT_EQUAL_INT(1, bench.propose_turned(0));
  bench.proposals.init();
  TEST_ASSERT_EQUAL_INT(1, bench.propose_turned(0));
}

void test_two_proposals_of_one_frame_should_count_once() {
  Bench bench;
  bench.propose_turned(0);
  bench.proposals.begin_frame(kFrameNs);
  TEST_ASSERT_EQUAL_INT(2, bench.propose());
  TEST_ASSERT_EQUAL_INT(2, bench.propose());
  TEST_ASSERT_EQUAL_INT(3, bench.propose_turned(0));
}

void test_a_depth_that_is_none_should_follow_nothing() {
  Bench bench;
  bench.propose_turned(0);
  TEST_ASSERT_EQUAL_INT(1, bench.propose_turned(0, 0, 0));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_proposals_that_a_hand_leads_to_should_add_up);
  RUN_TEST(test_a_jump_should_begin_anew);
  RUN_TEST(test_a_jump_should_take_what_the_prediction_was_worth);
  RUN_TEST(test_a_frame_that_proposes_nothing_should_end_the_row);
  RUN_TEST(test_two_proposals_of_one_frame_should_count_once);
  RUN_TEST(test_a_depth_that_is_none_should_follow_nothing);
  return UNITY_END();
}
