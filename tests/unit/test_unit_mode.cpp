// Modes of an inertial unit: what each event makes of each of them, and which of them move the body.
#include <initializer_list>

#include "inertial/unit_mode.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr UnitMode kModes[] = {UnitMode::kAbsent,   UnitMode::kUnaligned,   UnitMode::kAtRest, UnitMode::kMoves,
                               UnitMode::kSilent,   UnitMode::kGyroOnly,    UnitMode::kMetric, UnitMode::kProbation,
                               UnitMode::kRejected, UnitMode::kContradicted};
constexpr UnitEvent kEvents[] = {UnitEvent::kLeft,          UnitEvent::kUsed,   UnitEvent::kFrame,
                                 UnitEvent::kRest,          UnitEvent::kMotion, UnitEvent::kGoesOn,
                                 UnitEvent::kContradiction, UnitEvent::kMisfit, UnitEvent::kNewMap};
constexpr UnitUse kUses[] = {{false, false}, {true, false}, {false, true}, {true, true}};

void check(UnitMode mode, UnitEvent event, UnitMode expected, UnitUse use = UnitUse()) {
  TEST_ASSERT_EQUAL_INT(static_cast<int>(expected), static_cast<int>(next_mode(mode, event, use)));
}

}  // namespace

void test_absent_unit_should_stay_absent_whatever_happens() {
  for (const UnitEvent event : kEvents)
    for (const UnitUse& use : kUses) check(UnitMode::kAbsent, event, UnitMode::kAbsent, use);
  TEST_ASSERT_FALSE(uses_samples(UnitMode::kAbsent));
}

void test_used_unit_should_be_told_apart_by_metres_and_trial() {
  for (const UnitMode mode : {UnitMode::kSilent, UnitMode::kRejected, UnitMode::kUnaligned}) {
    check(mode, UnitEvent::kUsed, UnitMode::kGyroOnly, {false, false});
    check(mode, UnitEvent::kUsed, UnitMode::kMetric, {true, false});
    check(mode, UnitEvent::kUsed, UnitMode::kProbation, {false, true});
    check(mode, UnitEvent::kUsed, UnitMode::kProbation, {true, true});
  }
  check(UnitMode::kGyroOnly, UnitEvent::kFrame, UnitMode::kMetric, {true, false});
  check(UnitMode::kProbation, UnitEvent::kFrame, UnitMode::kMetric, {true, false});
  check(UnitMode::kAtRest, UnitEvent::kFrame, UnitMode::kAtRest, {true, false});
}

void test_unit_should_be_left_only_with_the_next_frame_when_pictures_contradict_it() {
  for (const UnitMode mode : {UnitMode::kGyroOnly, UnitMode::kMetric, UnitMode::kProbation, UnitMode::kAtRest}) {
    check(mode, UnitEvent::kContradiction, UnitMode::kContradicted);
    TEST_ASSERT_TRUE(uses_samples(UnitMode::kContradicted) && leaves_out(UnitMode::kContradicted));
  }
  check(UnitMode::kContradicted, UnitEvent::kLeft, UnitMode::kRejected);
  check(UnitMode::kContradicted, UnitEvent::kNewMap, UnitMode::kRejected);
  TEST_ASSERT_FALSE(uses_samples(UnitMode::kRejected));
}

void test_unaligned_unit_should_be_used_only_while_it_rests() {
  check(UnitMode::kUnaligned, UnitEvent::kRest, UnitMode::kAtRest);
  TEST_ASSERT_TRUE(uses_samples(UnitMode::kAtRest) && !leaves_out(UnitMode::kAtRest));
  check(UnitMode::kAtRest, UnitEvent::kMotion, UnitMode::kUnaligned);
  check(UnitMode::kUnaligned, UnitEvent::kGoesOn, UnitMode::kMoves);
  TEST_ASSERT_TRUE(uses_samples(UnitMode::kMoves) && leaves_out(UnitMode::kMoves));
  check(UnitMode::kMoves, UnitEvent::kLeft, UnitMode::kUnaligned);
  check(UnitMode::kAtRest, UnitEvent::kLeft, UnitMode::kUnaligned);
  check(UnitMode::kMetric, UnitEvent::kRest, UnitMode::kMetric);
  check(UnitMode::kUnaligned, UnitEvent::kMisfit, UnitMode::kRejected);
}

void test_silent_unit_should_not_be_held_against_it() {
  for (const UnitMode mode : {UnitMode::kGyroOnly, UnitMode::kMetric, UnitMode::kProbation, UnitMode::kSilent}) {
    check(mode, UnitEvent::kLeft, UnitMode::kSilent);
  }
  TEST_ASSERT_FALSE(is_rejected(UnitMode::kSilent) || leaves_out(UnitMode::kSilent));
}

/// Nothing but a prediction that begins without samples, or a map that does, takes them from a body that they move at once; and nothing but
/// such a prediction, or a rest, gives them to it.
void test_samples_should_come_and_go_with_a_prediction_when_the_body_moves() {
  for (const UnitMode mode : kModes)
    for (const UnitEvent event : kEvents)
      for (const UnitUse& use : kUses) {
        const bool before = uses_samples(mode), after = uses_samples(next_mode(mode, event, use));
        if (before && !after)
          TEST_ASSERT_TRUE(event == UnitEvent::kLeft || event == UnitEvent::kNewMap || mode == UnitMode::kAtRest);
        if (!before && after)
          TEST_ASSERT_TRUE(event == UnitEvent::kUsed || (mode == UnitMode::kUnaligned && event != UnitEvent::kFrame));
      }
}

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_absent_unit_should_stay_absent_whatever_happens);
  RUN_TEST(test_used_unit_should_be_told_apart_by_metres_and_trial);
  RUN_TEST(test_unit_should_be_left_only_with_the_next_frame_when_pictures_contradict_it);
  RUN_TEST(test_unaligned_unit_should_be_used_only_while_it_rests);
  RUN_TEST(test_silent_unit_should_not_be_held_against_it);
  RUN_TEST(test_samples_should_come_and_go_with_a_prediction_when_the_body_moves);
  return UNITY_END();
}
