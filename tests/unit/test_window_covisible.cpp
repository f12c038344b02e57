// Which keyframes of the window hang together by points that they share.
#include "slam/window_covisible.h"
#include "support/window_bench.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kInGroup = 12, kKeyframes = WindowBench::kKeyframes;

/// Points that all keyframes saw, of which one half stays with the first `cut` keyframes and the other with the rest.
void split(WindowBench* bench, int cut) {
  for (int n = 0; n < 2 * kInGroup; ++n) {
    const double x = bench->random.uniform(-0.3, 0.5), y = bench->random.uniform(-0.4, 0.4);
    const double z = bench->random.uniform(1.5, 3);
    const int i = bench->add(Vec3(static_cast<Scalar>(x), static_cast<Scalar>(y), static_cast<Scalar>(z)), 0);
    bench->place(i);
    for (int k = 0; k < kKeyframes; ++k)
      if ((k < cut) != (n < kInGroup)) bench->map.keyframes.pixels(k)[i].seen = false;
  }
}

/// Lets a keyframe see points of the other half.
void join(WindowBench* bench, int keyframe, int points) {
  for (int i = 0; i < points; ++i) bench->map.keyframes.pixels(keyframe)[i].seen = true;
}

void test_keyframes_should_hang_together_by_chains() {
  WindowBench bench(1);
  split(&bench, 2);
  bool connected[kKeyframes + 30];
  TEST_ASSERT_EQUAL_INT(kKeyframes - 2, connected_keyframes(bench.map, 8, connected));
  for (int k = 0; k < kKeyframes; ++k) TEST_ASSERT_EQUAL_INT(k >= 2, connected[k]);
  TEST_ASSERT_EQUAL_INT(0, shared_points(bench.map, 1, 2));
  TEST_ASSERT_EQUAL_INT(kInGroup, shared_points(bench.map, 0, 1));
  // The newest keyframe shares nothing with the first two, but one shares enough with both.
  join(&bench, 3, 7);
  TEST_ASSERT_EQUAL_INT(kKeyframes - 2, connected_keyframes(bench.map, 8, connected));
  join(&bench, 3, 8);
  TEST_ASSERT_EQUAL_INT(kKeyframes, connected_keyframes(bench.map, 8, connected));
}

void test_points_without_a_depth_should_connect_nothing() {
  WindowBench bench(2);
  split(&bench, 2);
  join(&bench, 3, kInGroup);
  for (int i = 0; i < kInGroup; ++i) bench.map.point(i).has_depth = false;
  bool connected[kKeyframes + 30];
  TEST_ASSERT_EQUAL_INT(kKeyframes - 2, connected_keyframes(bench.map, 8, connected));
}

/// They have a place and a scale of their own. Held fixed in the adjustment of the others they would hold neither.
void test_what_shares_no_points_should_neither_move_nor_hold_the_others() {
  WindowBench bench(3);
  split(&bench, 3);
  const Vec3 first = bench.map.keyframes[0].p_W, held = bench.map.keyframes[3].p_W;
  const Scalar held_rho = bench.map.point(0).rho;
  for (int k = 4; k < kKeyframes; ++k) bench.map.keyframes[k].p_W.y() += Scalar(0.01);
  TEST_ASSERT_TRUE(bench.adjustment.run(true));
  TEST_ASSERT_TRUE(first == bench.map.keyframes[0].p_W);
  TEST_ASSERT_TRUE(held_rho == bench.map.point(0).rho);
  // The oldest of those that hang together stays, and brings the others back to where their pixels are.
  TEST_ASSERT_TRUE(held == bench.map.keyframes[3].p_W);
  for (int k = 4; k < kKeyframes; ++k) {
    std::printf("keyframe %d: %.2f mm\n", k, 1e3 * static_cast<double>(bench.map.keyframes[k].p_W.y()));
    TEST_ASSERT_TRUE(std::abs(bench.map.keyframes[k].p_W.y()) < Scalar(0.002));
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_keyframes_should_hang_together_by_chains);
  RUN_TEST(test_points_without_a_depth_should_connect_nothing);
  RUN_TEST(test_what_shares_no_points_should_neither_move_nor_hold_the_others);
  return UNITY_END();
}
