// When a frame shows what the map has learnt from already: after enough frames in one view, and until the camera leaves it.
#include <cmath>

#include "filter_slam/features/same_view.h"
#include "geometry/so3.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr Scalar kDepth = 2, kFocal = 500, kEnough = 8;

SameView after(int frames) {
  SameView view;
  view.init();
  for (int i = 0; i < frames; ++i) view.note(Body(), kDepth, kFocal);
  return view;
}

bool is_learnt(const SameView& view, const Body& body) { return view.is_learnt(body, kDepth, kFocal, kEnough); }

void test_view_should_be_learnt_after_as_many_frames_as_errors_last() {
  TEST_ASSERT_FALSE(is_learnt(after(0), Body()));
  TEST_ASSERT_FALSE(is_learnt(after(7), Body()));
  TEST_ASSERT_TRUE(is_learnt(after(8), Body()));
  TEST_ASSERT_TRUE(is_learnt(after(100000), Body()));
}

void test_view_should_be_another_when_points_move_by_more_than_a_few_pixels() {
  Body near, turned, moved;
  near.q_WC = exp_so3(Vec3(Scalar(0), Scalar(0.002), Scalar(0)));  // 1 px, a little more in the corners
  turned.q_WC = exp_so3(Vec3(Scalar(0), Scalar(0.006), Scalar(0)));
  moved.p_W = Vec3(Scalar(0.012), Scalar(0), Scalar(0));  // 3 px of points at the median depth
  TEST_ASSERT_TRUE(is_learnt(after(20), near));
  TEST_ASSERT_FALSE(is_learnt(after(20), turned));
  TEST_ASSERT_FALSE(is_learnt(after(20), moved));
}

/// Around the point on the axis at the median depth: what is there stays where it is, and what is near that depth hardly moves.
Body orbited(Scalar angle) {
  const Vec3 middle(Scalar(0), Scalar(0), kDepth);
  Body body;
  body.q_WC = exp_so3(Vec3(Scalar(0), angle, Scalar(0)));
  body.p_W = middle - body.q_WC * middle;
  return body;
}

/// The estimate of a camera at rest once drifted so, by half a millimetre a frame, and was taken for a moving one for six seconds.
void test_a_drift_about_what_is_seen_should_be_the_same_view_until_points_near_it_move() {
  TEST_ASSERT_TRUE(
      is_learnt(after(20), orbited(Scalar(0.005))));  // 2.5 px of rotation, as many of parallax, 1.5 px of both
  TEST_ASSERT_FALSE(is_learnt(after(20), orbited(Scalar(0.03))));
}

void test_slow_motion_should_begin_new_views() {
  SameView view = after(20);
  Body body;
  int learnt = 0;
  for (int i = 0; i < 100; ++i) {
    body.p_W.x() += Scalar(0.002);  // half a pixel
    learnt += is_learnt(view, body);
    view.note(body, kDepth, kFocal);
  }
  TEST_ASSERT_TRUE(learnt < 10);
}

void test_view_should_be_forgotten_after_a_frame_that_was_not_tracked() {
  SameView view = after(20);
  view.forget();
  TEST_ASSERT_FALSE(is_learnt(view, Body()));
  view.note(Body(), kDepth, kFocal);
  TEST_ASSERT_FALSE(is_learnt(view, Body()));
}

void test_view_should_not_be_learnt_at_a_pose_that_is_no_number() {
  Body body;
  body.p_W.x() = Scalar(NAN);
  TEST_ASSERT_FALSE(is_learnt(after(20), body));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_view_should_be_learnt_after_as_many_frames_as_errors_last);
  RUN_TEST(test_view_should_be_another_when_points_move_by_more_than_a_few_pixels);
  RUN_TEST(test_a_drift_about_what_is_seen_should_be_the_same_view_until_points_near_it_move);
  RUN_TEST(test_slow_motion_should_begin_new_views);
  RUN_TEST(test_view_should_be_forgotten_after_a_frame_that_was_not_tracked);
  RUN_TEST(test_view_should_not_be_learnt_at_a_pose_that_is_no_number);
  return UNITY_END();
}
