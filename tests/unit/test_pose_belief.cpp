// The log-odds of the pose: what a frame adds, what time takes, and how few frames undo any past.
#include <cmath>

#include "belief/pose_belief.h"
#include "belief/tuning.h"
#include "unity.h"

using namespace pf;
using namespace tuning::pose_belief;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr double kFrame = 1.0 / 30;
constexpr Scalar kMuch = 100;

/// A frame whose consensus says `evidence` for the predicted pose.
bool weigh(PoseBelief* belief, Scalar evidence, double dt_s = kFrame) {
  belief->begin_frame(dt_s);
  const Scalar log_odds = PoseBelief::updated(belief->predicted(), evidence);
  belief->note(log_odds);
  if (PoseBelief::is_enough(log_odds)) belief->use(log_odds, PoseConsensus());
  return belief->is_tracked();
}

void test_a_new_map_should_need_two_frames() {
  PoseBelief belief;
  TEST_ASSERT_FALSE(weigh(&belief, kMuch));
  TEST_ASSERT_TRUE(weigh(&belief, kMuch));
}

void test_what_comes_from_a_target_should_be_tracked_at_once() {
  PoseBelief belief;
  belief.trust();
  TEST_ASSERT_TRUE(belief.is_tracked());
  TEST_ASSERT_TRUE(weigh(&belief, 0));
}

void test_frames_that_say_nothing_should_be_tracked_for_as_long_as_a_cut_is_unlikely() {
  PoseBelief belief;
  belief.trust();
  double silent_s = 0;
  while (weigh(&belief, 0, 0.1) && silent_s < 10) silent_s += 0.1;
  // 1 - p = kHazard t reaches that of kTracked, 0.2 %.
  TEST_ASSERT_DOUBLE_WITHIN(0.11, static_cast<double>(std::exp(-static_cast<double>(kTracked)) / kHazard),
                            static_cast<double>(silent_s));
}

void test_three_frames_should_undo_any_past() {
  PoseBelief belief;
  for (int frame = 0; frame < 1000; ++frame) weigh(&belief, kMuch);
  int against = 0;
  while (belief.log_odds() > Scalar(0)) {
    weigh(&belief, -kMuch);
    ++against;
  }
  TEST_ASSERT_LESS_OR_EQUAL_INT(3, against);
}

void test_one_frame_after_one_in_vain_should_be_enough_and_two_after_many() {
  PoseBelief belief;
  belief.trust();
  weigh(&belief, -5);
  TEST_ASSERT_TRUE(weigh(&belief, kMuch));
  for (int frame = 0; frame < 100; ++frame) weigh(&belief, -5);
  TEST_ASSERT_FALSE(weigh(&belief, kMuch));
  TEST_ASSERT_TRUE(weigh(&belief, kMuch));
}

void test_a_vague_prediction_should_have_no_past() {
  PoseBelief belief;
  belief.trust();
  belief.begin_frame(kFrame);
  belief.spend();
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, static_cast<double>(kElsewhere), static_cast<double>(belief.predicted()));
  TEST_ASSERT_FALSE(belief.is_tracked());
}

void test_the_best_hypothesis_of_a_frame_should_count() {
  PoseBelief belief;
  belief.begin_frame(kFrame);
  belief.note(-5);
  belief.note(2);
  belief.note(-1);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, static_cast<double>(2), static_cast<double>(belief.log_odds()));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_a_new_map_should_need_two_frames);
  RUN_TEST(test_what_comes_from_a_target_should_be_tracked_at_once);
  RUN_TEST(test_frames_that_say_nothing_should_be_tracked_for_as_long_as_a_cut_is_unlikely);
  RUN_TEST(test_three_frames_should_undo_any_past);
  RUN_TEST(test_one_frame_after_one_in_vain_should_be_enough_and_two_after_many);
  RUN_TEST(test_a_vague_prediction_should_have_no_past);
  RUN_TEST(test_the_best_hypothesis_of_a_frame_should_count);
  return UNITY_END();
}
