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
constexpr int kYoung = 5;  // frames of a walk before what stands still is in the map

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
  Vec3 place_W[kAll];
  Quat q_WC = Quat::Identity();
  Vec3 c_W = Vec3::Zero();
  bool has_pose = false;
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
  void add(int feature, const Vec2& pixel, MatchStatus status, BlockKind kind = BlockKind::kPoint) {
    const Vec2 found = pixel + random.normals<2>(kMatchPx);
    frame.add({feature, static_cast<std::uint32_t>(feature + 1), status, kind, true, false, pixel, Mat2::Identity(),
               found, Scalar(0)});
    frame.report.inliers += status == MatchStatus::kInlier ? 1 : 0;
  }
  bool note() {
    const KnownScene scene = {
        {q_WC, c_W}, place_W, [](const void* place, int i) { return static_cast<const Vec3*>(place)[i]; }};
    return fixed.note(camera, has_pose ? &scene : nullptr, &frame, &features);
  }
  /// Frames of a walk along a wall at a distance of one, with a pose; what stands still has places as if at `depth` when the walk began,
  /// and is of these kind and status.
  void walk(int frames, double rad, double depth, BlockKind kind, MatchStatus status) {
    has_pose = true;
    for (int i = 0; i < kScene; ++i) place_W[i] = ray_W[i] / ray_W[i].z();
    for (int i = 0; i < kFixed; ++i) {
      Vec3 ray;
      TEST_ASSERT_TRUE(unproject(camera, still[i], &ray));
      place_W[kScene + i] = static_cast<Scalar>(depth) * ray;
    }
    for (int k = 0; k < frames; ++k) {
      q_WC = exp_so3(Vec3(0, static_cast<Scalar>(rad * std::sin(0.7 * k)), 0));
      c_W = Vec3(Scalar(0.005) * static_cast<Scalar>(k), 0, 0);
      frame.begin(frame.report.t_ns + 33333333);
      for (int i = 0; i < kScene; ++i) {
        Vec2 pixel;
        if (project(camera, q_WC.conjugate() * (place_W[i] - c_W), &pixel)) add(i, pixel, MatchStatus::kInlier);
      }
      for (int i = 0; i < kFixed; ++i)
        if (k > kYoung && fixed.mask()->is_clear(still[i], 0)) add(kScene + i, still[i], status, kind);
      discredited = note() || discredited;
    }
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
    discredited = note() || discredited;
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
    TEST_ASSERT_FALSE(bench.note());
  }
  TEST_ASSERT_EQUAL_INT(0, bench.scene_masked());
}

void test_what_is_far_away_should_not_be_masked_while_the_camera_passes_a_wall() {
  for (const BlockKind kind : {BlockKind::kPoint, BlockKind::kInverseDepth})
    for (const MatchStatus status : {MatchStatus::kInlier, MatchStatus::kOutlier}) {
      Bench bench;
      bench.walk(120, 0, 1e4, kind, status);
      TEST_ASSERT_EQUAL_INT(0, bench.masked() + bench.scene_masked());
      TEST_ASSERT_EQUAL_INT(0, bench.frame.masked);
      TEST_ASSERT_FALSE(bench.discredited);
    }
}

/// The camera goes around a point: what is near it stands still, and its depth need not be known.
void test_what_the_camera_goes_around_should_not_be_masked() {
  Bench bench;
  bench.has_pose = true;
  for (int i = 0; i < kScene; ++i) bench.place_W[i] = 4 * bench.ray_W[i];
  Vec3 around_W[kFixed];
  for (int i = 0; i < kFixed; ++i) {
    TEST_ASSERT_TRUE(unproject(bench.camera, Vec2(Scalar(159.5), Scalar(119.5)) + Vec2(3 * i - 15, 0), &around_W[i]));
    bench.still[i] = Vec2(Scalar(159.5), Scalar(119.5)) + Vec2(3 * i - 15, 0);
  }
  for (int k = 0; k < 60; ++k) {
    bench.q_WC = exp_so3(Vec3(0, Scalar(-0.004) * static_cast<Scalar>(k), 0));
    bench.c_W = Vec3(0, 0, 1) - bench.q_WC * Vec3(0, 0, 1);
    bench.frame.begin(bench.frame.report.t_ns + 33333333);
    for (int i = 0; i < (k > kYoung ? kAll : kScene); ++i) {
      const bool is_near = i >= kScene;
      Vec2 pixel;
      if (project(bench.camera,
                  bench.q_WC.conjugate() * ((is_near ? around_W[i - kScene] : bench.place_W[i]) - bench.c_W), &pixel))
        bench.add(i, pixel, MatchStatus::kInlier, is_near ? BlockKind::kInverseDepth : BlockKind::kPoint);
    }
    TEST_ASSERT_FALSE(bench.note());
  }
  TEST_ASSERT_EQUAL_INT(0, bench.masked() + bench.scene_masked());
}

void test_a_body_should_be_masked_while_the_camera_passes_a_wall() {
  {
    Bench bench;  // its places are known, and it does not leave them behind
    bench.walk(60, 0, 1, BlockKind::kPoint, MatchStatus::kOutlier);
    TEST_ASSERT_EQUAL_INT(kFixed, bench.masked());
    TEST_ASSERT_EQUAL_INT(0, bench.scene_masked());
    TEST_ASSERT_TRUE(bench.frame.masked > 0);
  }
  {
    Bench bench;  // it may be far away, but the camera rotates by up to half a degree as well
    bench.walk(120, 0.008, 1e4, BlockKind::kInverseDepth, MatchStatus::kInlier);
    TEST_ASSERT_EQUAL_INT(kFixed, bench.masked());
    TEST_ASSERT_EQUAL_INT(0, bench.scene_masked());
  }
}

void test_a_pose_that_comes_from_what_is_fixed_should_not_judge() {
  Bench bench;
  bench.has_pose = true;  // it stays where it was
  for (int i = 0; i < kScene; ++i) bench.place_W[i] = bench.ray_W[i];
  Quat q_WC = Quat::Identity();
  for (int k = 0; k < 30; ++k) {
    bench.q_WC = q_WC = q_WC * exp_so3(Vec3(0, Scalar(0.005), 0));
    bench.frame.begin(bench.frame.report.t_ns + 33333333);
    for (int i = 0; i < kScene; ++i) {
      Vec2 pixel;
      if (project(bench.camera, q_WC.conjugate() * bench.ray_W[i], &pixel) && pixel.x() > 0 && pixel.x() < kWidth)
        bench.add(i, pixel, MatchStatus::kOutlier);
    }
    for (int i = 0; i < kFixed; ++i)
      if (bench.fixed.mask()->is_clear(bench.still[i], 0)) bench.add(kScene + i, bench.still[i], MatchStatus::kInlier);
    bench.q_WC = Quat::Identity();
    bench.discredited = bench.note() || bench.discredited;
  }
  TEST_ASSERT_EQUAL_INT(kFixed, bench.masked());
  TEST_ASSERT_TRUE(bench.discredited);
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
  RUN_TEST(test_what_is_far_away_should_not_be_masked_while_the_camera_passes_a_wall);
  RUN_TEST(test_what_the_camera_goes_around_should_not_be_masked);
  RUN_TEST(test_a_body_should_be_masked_while_the_camera_passes_a_wall);
  RUN_TEST(test_a_pose_that_comes_from_what_is_fixed_should_not_judge);
  RUN_TEST(test_what_the_caller_masks_should_be_masked_besides);
  return UNITY_END();
}
