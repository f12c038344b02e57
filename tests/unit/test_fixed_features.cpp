// What stands still in the picture while it moves: a rotating camera, features of the scene and features that are fixed to the picture.
#include "base/arena.h"
#include "belief/feature_belief.h"
#include "frame/fixed_features.h"
#include "geometry/so3.h"
#include "support/filter_cases.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr int kScene = 20, kFixed = 10, kAll = kScene + kFixed;
constexpr double kMatchPx = 0.1;

struct Bench {
  SeededRandom random{211};
  Camera camera = test_camera(CameraModel::kPinhole, kWidth, kHeight, 260, 260, 159.5, 119.5);
  TestArena arena;
  FixedFeatures fixed;
  ImageMask callers;
  FeatureTable features;
  Frame frame;
  Vec3 ray_W[kScene];
  Vec2 still[kFixed];
  Quat q_WC = Quat::Identity();
  bool discredited = false;

  Bench() {
    TEST_ASSERT_TRUE(fixed.layout(*arena, kWidth, kHeight, kAll));
    TEST_ASSERT_TRUE(callers.layout(*arena, kWidth, kHeight));
    TEST_ASSERT_TRUE(frame.layout(*arena, kAll));
    TEST_ASSERT_TRUE(features.layout(*arena, kAll));
    features.init();
    for (int i = 0; i < kAll; ++i) TEST_ASSERT_EQUAL_INT(i, features.add(i));
    callers.init();
    frame.init();
    fixed.init(&callers);
    for (Vec3& ray : ray_W) TEST_ASSERT_TRUE(unproject(camera, place(0, 140), &ray));
    for (Vec2& pixel : still) pixel = place(170, 230);
  }
  Vec2 place(double top, double bottom) {
    return {static_cast<Scalar>(random.uniform(60, 260)), static_cast<Scalar>(random.uniform(top, bottom))};
  }
  void add(int feature, const Vec2& pixel, MatchStatus status) {
    const Vec2 found = pixel + random.normals<2>(kMatchPx);
    frame.add({feature, static_cast<std::uint32_t>(feature + 1), status, BlockKind::kPoint, true, pixel,
               Mat2::Identity(), found, Scalar(0)});
    frame.report.inliers += status == MatchStatus::kInlier ? 1 : 0;
  }
  /// One frame. Those of the picture are its inliers where `follows_fixed`, those of the scene else.
  void show(bool follows_fixed) {
    frame.begin(frame.report.t_ns + 33333333);
    for (int i = 0; i < kScene; ++i) {
      Vec2 pixel;
      if (project(camera, q_WC.conjugate() * ray_W[i], &pixel) && pixel.x() > 0 && pixel.x() < kWidth)
        add(i, pixel, follows_fixed ? MatchStatus::kOutlier : MatchStatus::kInlier);
    }
    for (int i = 0; i < kFixed; ++i)
      if (fixed.mask()->is_clear(still[i], 0))
        add(kScene + i, still[i], follows_fixed ? MatchStatus::kInlier : MatchStatus::kOutlier);
    discredited = fixed.note(camera, frame, &features) || discredited;
  }
  void turn(int frames, double rad_per_frame, bool follows_fixed) {
    for (int k = 0; k < frames; ++k) {
      q_WC = q_WC * exp_so3(Vec3(0, static_cast<Scalar>(rad_per_frame), 0));
      show(follows_fixed);
    }
  }
  int masked() const {
    int count = 0;
    for (const Vec2& pixel : still) count += fixed.mask()->is_clear(pixel, 0) ? 0 : 1;
    return count;
  }
  int scene_masked() const {
    int count = 0;
    for (const Vec3& ray : ray_W) {
      Vec2 pixel;
      count += project(camera, q_WC.conjugate() * ray, &pixel) && !fixed.mask()->is_clear(pixel, 0) ? 1 : 0;
    }
    return count;
  }
};

void test_what_is_fixed_should_be_masked_once_the_picture_has_moved() {
  Bench bench;
  bench.turn(30, 0.005, false);  // 1.3 px a frame
  TEST_ASSERT_EQUAL_INT(kFixed, bench.masked());
  TEST_ASSERT_EQUAL_INT(0, bench.scene_masked());
  TEST_ASSERT_FALSE(bench.discredited);
  for (int i = 0; i < kAll; ++i)
    TEST_ASSERT_EQUAL_INT(i >= kScene, is_no_point(static_cast<Scalar>(bench.features[i].log_odds)));
}

void test_a_map_that_comes_from_what_is_fixed_should_be_discredited() {
  Bench bench;
  bench.turn(30, 0.005, true);
  TEST_ASSERT_EQUAL_INT(kFixed, bench.masked());
  TEST_ASSERT_TRUE(bench.discredited);
}

void test_nothing_should_be_masked_while_the_camera_rests() {
  Bench bench;
  bench.turn(120, 0, false);
  TEST_ASSERT_EQUAL_INT(0, bench.masked() + bench.scene_masked());
}

void test_what_is_fixed_should_be_known_before_the_camera_has_turned_by_two_degrees() {
  Bench bench;
  bench.turn(7, 0.005, true);  // 9 px
  TEST_ASSERT_EQUAL_INT(kFixed, bench.masked());
  TEST_ASSERT_TRUE(bench.discredited);
}

void test_things_that_move_before_a_resting_camera_should_mask_nothing() {
  Bench bench;
  for (int k = 0; k < 60; ++k) {  // fewer than half of what is found: a person walks by
    bench.frame.begin(bench.frame.report.t_ns + 33333333);
    for (int i = 0; i < kFixed; ++i)
      bench.add(kScene + i, bench.still[i] - Vec2(static_cast<Scalar>(k), 0), MatchStatus::kOutlier);
    for (int i = 0; i < kScene; ++i) {
      Vec2 pixel;
      TEST_ASSERT_TRUE(project(bench.camera, bench.ray_W[i], &pixel));
      bench.add(i, pixel, MatchStatus::kInlier);
    }
    TEST_ASSERT_FALSE(bench.fixed.note(bench.camera, bench.frame, &bench.features));
  }
  TEST_ASSERT_EQUAL_INT(0, bench.scene_masked());
}

/// Along a near wall: what is far away hardly moves, and the frame's pose explains both.
void test_what_is_far_away_should_not_be_masked_while_the_camera_translates() {
  Bench bench;
  for (int k = 0; k < 60; ++k) {
    bench.frame.begin(bench.frame.report.t_ns + 33333333);
    for (int i = 0; i < kScene; ++i) {
      Vec2 pixel;
      if (project(bench.camera, bench.ray_W[i] - Vec3(Scalar(0.005) * static_cast<Scalar>(k), 0, 0), &pixel))
        bench.add(i, pixel, MatchStatus::kInlier);
    }
    for (int i = 0; i < kFixed; ++i) bench.add(kScene + i, bench.still[i], MatchStatus::kInlier);
    TEST_ASSERT_FALSE(bench.fixed.note(bench.camera, bench.frame, &bench.features));
  }
  TEST_ASSERT_EQUAL_INT(0, bench.masked() + bench.scene_masked());
}

void test_what_the_caller_masks_should_be_masked_besides() {
  Bench bench;
  const Vec2 pixel(40, 40);
  bench.callers.assign([](const Rect& cell) { return cell.x == 40 && cell.y == 40; });
  TEST_ASSERT_FALSE(bench.fixed.mask()->is_clear(pixel, 0));
  bench.callers.init();
  TEST_ASSERT_TRUE(bench.fixed.mask()->is_clear(pixel, 0));
  bench.turn(30, 0.005, false);
  TEST_ASSERT_TRUE(bench.fixed.mask()->has_masked());
  bench.fixed.init(&bench.callers);
  TEST_ASSERT_FALSE(bench.fixed.mask()->has_masked());
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_what_is_fixed_should_be_masked_once_the_picture_has_moved);
  RUN_TEST(test_a_map_that_comes_from_what_is_fixed_should_be_discredited);
  RUN_TEST(test_nothing_should_be_masked_while_the_camera_rests);
  RUN_TEST(test_what_is_fixed_should_be_known_before_the_camera_has_turned_by_two_degrees);
  RUN_TEST(test_things_that_move_before_a_resting_camera_should_mask_nothing);
  RUN_TEST(test_what_is_far_away_should_not_be_masked_while_the_camera_translates);
  RUN_TEST(test_what_the_caller_masks_should_be_masked_besides);
  return UNITY_END();
}
