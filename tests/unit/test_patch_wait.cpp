// Which plane a patch lies on: only one that passes is joined, two wait, and where none passes it founds one or is given up.
#include "same.h"
#include "track/patch_wait.h"
#include "track/tuning.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr float kGate = 26.12f, kUnder = 8, kOver = 100;
constexpr int kPersist = tuning::patch_wait::kPersist, kMaxFrames = tuning::patch_wait::kMaxFrames;

struct Tried {
  std::uint32_t plane;
  bool known;
  float chi2;
};

template <int N>
WaitVerdict see(PatchWait* wait, const Tried (&planes)[N], bool has_parallax, std::uint32_t* joined) {
  wait->begin_frame();
  for (const Tried& t : planes) wait->try_plane(t.plane, t.known, t.chi2, kGate);
  return wait->decide(has_parallax, joined);
}

PatchWait begun() {
  PatchWait wait;
  wait.begin();
  TEST_ASSERT_TRUE(wait.waits());
  return wait;
}

void test_the_only_plane_that_passes_should_be_joined_when_there_is_parallax() {
  PatchWait wait = begun();
  std::uint32_t joined = 0;
  for (int frame = 0; frame < 10; ++frame)
    TEST_ASSERT_SAME(WaitVerdict::kWait, see(&wait, {{7, true, kUnder}}, false, &joined));
  TEST_ASSERT_TRUE(wait.passes(7) && !wait.passes(8));
  for (int frame = 1; frame < kPersist; ++frame)
    TEST_ASSERT_SAME(WaitVerdict::kWait, see(&wait, {{7, true, kUnder}}, true, &joined));
  TEST_ASSERT_SAME(WaitVerdict::kJoin, see(&wait, {{7, true, kUnder}}, true, &joined));
  TEST_ASSERT_EQUAL_UINT32(7, joined);
}

void test_the_only_plane_should_be_joined_without_parallax_after_a_second() {
  PatchWait wait = begun();
  std::uint32_t joined = 0;
  int frames = 1;
  while (see(&wait, {{7, true, kUnder}}, false, &joined) == WaitVerdict::kWait) ++frames;
  TEST_ASSERT_EQUAL_INT(kMaxFrames, frames);
  TEST_ASSERT_EQUAL_UINT32(7, joined);
}

void test_frames_that_do_not_count_should_not_let_it_join_without_parallax() {
  PatchWait wait = begun();
  std::uint32_t joined = 0;
  for (int frame = 0; frame < 3 * kMaxFrames; ++frame) {
    wait.begin_frame(false);
    wait.try_plane(7, true, kUnder, kGate);
    TEST_ASSERT_SAME(WaitVerdict::kWait, wait.decide(false, &joined));
  }
  for (int frame = 1; frame < kPersist; ++frame)
    TEST_ASSERT_SAME(WaitVerdict::kWait, see(&wait, {{7, true, kUnder}}, true, &joined));
  TEST_ASSERT_SAME(WaitVerdict::kJoin, see(&wait, {{7, true, kUnder}}, true, &joined));
}

void test_two_walls_that_pass_should_wait_until_one_of_them_does_not() {
  PatchWait wait = begun();
  std::uint32_t joined = 0;
  for (int frame = 0; frame < 3 * kMaxFrames; ++frame)
    TEST_ASSERT_SAME(WaitVerdict::kWait, see(&wait, {{7, true, kUnder}, {8, true, kUnder + 1}}, true, &joined));
  TEST_ASSERT_EQUAL_INT(2, wait.open());
  TEST_ASSERT_EQUAL_UINT32(7, wait.likely());
  // A single frame says nothing.
  TEST_ASSERT_SAME(WaitVerdict::kWait, see(&wait, {{7, true, kOver}, {8, true, kUnder}}, true, &joined));
  TEST_ASSERT_SAME(WaitVerdict::kWait, see(&wait, {{7, true, kUnder}, {8, true, kUnder}}, true, &joined));
  for (int frame = 1; frame < kPersist; ++frame)
    TEST_ASSERT_SAME(WaitVerdict::kWait, see(&wait, {{7, true, kOver}, {8, true, kUnder}}, true, &joined));
  TEST_ASSERT_SAME(WaitVerdict::kJoin, see(&wait, {{7, true, kOver}, {8, true, kUnder}}, true, &joined));
  TEST_ASSERT_EQUAL_UINT32(8, joined);
}

void test_a_wall_should_go_before_a_plane_that_was_found_where_nothing_tells_them_apart() {
  PatchWait wait = begun();
  std::uint32_t joined = 0;
  int frames = 1;
  while (see(&wait, {{9, false, kUnder}, {7, true, kUnder}}, true, &joined) == WaitVerdict::kWait) ++frames;
  TEST_ASSERT_EQUAL_INT(kMaxFrames, frames);
  TEST_ASSERT_EQUAL_UINT32(7, joined);
}

void test_a_plane_that_is_gone_should_not_be_waited_for() {
  PatchWait wait = begun();
  std::uint32_t joined = 0;
  for (int frame = 0; frame < kPersist; ++frame)
    TEST_ASSERT_SAME(WaitVerdict::kWait, see(&wait, {{7, true, kUnder}, {8, true, kUnder}}, true, &joined));
  TEST_ASSERT_SAME(WaitVerdict::kJoin, see(&wait, {{8, true, kUnder}}, true, &joined));
  TEST_ASSERT_EQUAL_UINT32(8, joined);
}

void test_a_patch_that_nothing_explains_should_found_a_plane_only_with_parallax() {
  for (const bool has_parallax : {false, true}) {
    PatchWait wait = begun();
    std::uint32_t joined = 0;
    WaitVerdict verdict = WaitVerdict::kWait;
    int frames = 0;
    for (; verdict == WaitVerdict::kWait; ++frames) {
      verdict = see(&wait, {{7, true, kOver}, {8, true, kOver}}, has_parallax, &joined);
      TEST_ASSERT_EQUAL_INT(frames + 1, wait.frames_without());
    }
    TEST_ASSERT_EQUAL_INT(kMaxFrames, frames);
    TEST_ASSERT_SAME((has_parallax ? WaitVerdict::kFound : WaitVerdict::kGiveUp), verdict);
    TEST_ASSERT_EQUAL_UINT32(0, joined);
  }
}

void test_more_planes_than_there_is_room_for_should_be_left_out() {
  PatchWait wait = begun();
  std::uint32_t joined = 0;
  for (int frame = 0; frame < 300; ++frame) {  // longer than a byte counts
    wait.begin_frame();
    for (std::uint32_t plane = 1; plane <= 2 * PatchWait::kMaxTrials; ++plane)
      wait.try_plane(plane, true, kUnder, kGate);
    TEST_ASSERT_SAME(WaitVerdict::kWait, wait.decide(true, &joined));
  }
  TEST_ASSERT_EQUAL_INT(PatchWait::kMaxTrials, wait.open());
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_the_only_plane_that_passes_should_be_joined_when_there_is_parallax);
  RUN_TEST(test_the_only_plane_should_be_joined_without_parallax_after_a_second);
  RUN_TEST(test_frames_that_do_not_count_should_not_let_it_join_without_parallax);
  RUN_TEST(test_two_walls_that_pass_should_wait_until_one_of_them_does_not);
  RUN_TEST(test_a_wall_should_go_before_a_plane_that_was_found_where_nothing_tells_them_apart);
  RUN_TEST(test_a_plane_that_is_gone_should_not_be_waited_for);
  RUN_TEST(test_a_patch_that_nothing_explains_should_found_a_plane_only_with_parallax);
  RUN_TEST(test_more_planes_than_there_is_room_for_should_be_left_out);
  return UNITY_END();
}
