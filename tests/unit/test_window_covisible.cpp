// Which keyframes of the window hang together by points that they share.
#include "keyframe_slam/map/covisible.h"
#include "same.h"
#include "support/window_bench.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kInGroup = 12, kKeyframes = KeyframeBench::kKeyframes;

/// Points that all keyframes saw, of which one half stays with the first `cut` keyframes and the other with the rest.
void split(KeyframeBench* bench, int cut) {
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
void join(KeyframeBench* bench, int keyframe, int points) {
  for (int i = 0; i < points; ++i) bench->map.keyframes.pixels(keyframe)[i].seen = true;
}

void test_keyframes_should_hang_together_by_points_that_they_share() {
  KeyframeBench bench(1);
  split(&bench, 2);
  bool connected[kKeyframes + 30], seen[KeyframeBench::kPoints];
  TEST_ASSERT_EQUAL_INT(kKeyframes - 2, connected_keyframes(bench.map, 8, connected, seen));
  for (int k = 0; k < kKeyframes; ++k) TEST_ASSERT_EQUAL_INT(k >= 2, connected[k]);
  join(&bench, 3, 7);
  TEST_ASSERT_EQUAL_INT(kKeyframes - 2, connected_keyframes(bench.map, 8, connected, seen));
  // One that sees enough of both connects them, and so do two that see a part each.
  for (int i = 7; i < 9; ++i) bench.map.keyframes.pixels(4)[i].seen = true;
  TEST_ASSERT_EQUAL_INT(kKeyframes, connected_keyframes(bench.map, 8, connected, seen));
}

void test_points_without_a_depth_should_connect_nothing() {
  KeyframeBench bench(2);
  split(&bench, 2);
  join(&bench, 3, kInGroup);
  for (int i = 0; i < kInGroup; ++i) bench.map.point(i).has_depth = false;
  bool connected[kKeyframes + 30], seen[KeyframeBench::kPoints];
  TEST_ASSERT_EQUAL_INT(kKeyframes - 2, connected_keyframes(bench.map, 8, connected, seen));
}

/// They have a place and a scale of their own. Held fixed in the adjustment of the others they would hold neither.
void test_what_shares_no_points_should_neither_move_nor_hold_the_others() {
  KeyframeBench bench(3);
  split(&bench, 3);
  const Vec3 first = bench.map.keyframes[0].p_W, held = bench.map.keyframes[3].p_W;
  const Scalar held_rho = bench.map.point(0).rho;
  for (int k = 4; k < kKeyframes; ++k) bench.map.keyframes[k].p_W.y() += Scalar(0.01);
  TEST_ASSERT_TRUE(bench.adjustment.run(true));
  TEST_ASSERT_SAME(bench.map.keyframes[0].p_W, first);
  TEST_ASSERT_SAME(bench.map.point(0).rho, held_rho);
  // The oldest of those that hang together stays, and brings the others back to where their pixels are.
  TEST_ASSERT_SAME(bench.map.keyframes[3].p_W, held);
  for (int k = 4; k < kKeyframes; ++k) {
    std::printf("keyframe %d: %.2f mm\n", k, 1e3 * static_cast<double>(bench.map.keyframes[k].p_W.y()));
    TEST_ASSERT_TRUE(std::abs(bench.map.keyframes[k].p_W.y()) < Scalar(0.002));
  }
}

/// Turning the keyframe that is held turns the newest one about it, 0.2 m away along x.
void test_a_keyframe_that_is_held_should_pass_on_its_own_covariance() {
  KeyframeBench bench(4), exact(4);
  split(&bench, 3);
  split(&exact, 3);
  Mat6& P = bench.map.keyframes[3].covariance;
  P(2, 2) = Scalar(0.01);
  P(3, 3) = Scalar(0.04);
  TEST_ASSERT_TRUE(bench.adjustment.run(true) && exact.adjustment.run(true));
  const Mat6 added = bench.adjustment.map_covariance() - exact.adjustment.map_covariance();
  Mat6 wanted = P;
  wanted(4, 4) = Scalar(0.01 * 0.2 * 0.2);
  wanted(2, 4) = wanted(4, 2) = Scalar(0.01 * 0.2);
  TEST_ASSERT_TRUE((added - wanted).cwiseAbs().maxCoeff() < Scalar(1e-4));
  TEST_ASSERT_SAME(bench.adjustment.map_covariance(), bench.map.keyframes[5].covariance);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_keyframes_should_hang_together_by_points_that_they_share);
  RUN_TEST(test_points_without_a_depth_should_connect_nothing);
  RUN_TEST(test_what_shares_no_points_should_neither_move_nor_hold_the_others);
  RUN_TEST(test_a_keyframe_that_is_held_should_pass_on_its_own_covariance);
  return UNITY_END();
}
