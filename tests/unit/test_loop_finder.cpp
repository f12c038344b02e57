// A camera that comes back to a place with a window that has drifted: it is found where it is, and not where another texture is, nor where
// drift does not let it be.
#include <unity.h>

#include <cmath>

#include "keyframe_slam/loops/loop_finder.h"
#include "support/seeded_random.h"
#include "support/test_cameras.h"
#include "support/textured_images.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kWidth = 320, kHeight = 240, kPoints = 20;
constexpr Scalar kDepth = 2;
constexpr Scalar kSigma = Scalar(0.05);  // of the drift, in each direction

/// Cameras that look along z at a wall with a texture, and a place at the origin with points of it.
struct Bench {
  SeededRandom random{51};
  Settings settings;
  Map tables;
  Frame frame;
  NoiseModel noise;
  KeyframeMap map{settings, tables, frame};
  PoseBelief belief;
  ImageSearch images;
  LoopFinder finder{settings, map, noise, images, belief};
  KeyframeMotion motion{settings};
  DriftChain chain;
  TestArena arena{std::size_t{16} << 20};
  Texture wall{&random, 9, 60}, other{&random, 9, 60};

  Bench() {
    settings.camera = test_camera(CameraModel::kPinhole, kWidth, kHeight, 260, 260, 159.5, 119.5);
    settings.max_features = 40;
    settings.max_planes = 1;
    settings.kept.places = 4;
    settings.gate = Scalar(9.21);
    settings.min_inliers = 6;
    settings.border_px = 8;
    TEST_ASSERT_TRUE(tables.layout(*arena, settings.max_features, settings.max_planes, 0, 8));
    TEST_ASSERT_TRUE(frame.layout(*arena, 2 * settings.max_features));
    TEST_ASSERT_TRUE(map.layout(*arena));
    TEST_ASSERT_TRUE(images.layout(*arena, settings));
    TEST_ASSERT_TRUE(finder.layout(*arena));
    TEST_ASSERT_TRUE(chain.layout(*arena, 8));
    tables.init();
    frame.init();
    map.init();
    map.places.init();
    images.init(settings);
    finder.init();
    chain.init();
    noise.init(Scalar(0.3));
    MapDrift drift;
    drift.any = true;
    drift.Q = Mat6::Identity() * Scalar(1e-4);
    drift.Q.bottomRightCorner<3, 3>() = Mat3::Identity() * (kSigma * kSigma);
    drift.sigma_scale = Scalar(0.02);
    chain.add(1, 0, MapDrift(), Vec3::Zero());
    chain.add(9, 0, drift, Vec3::Zero());
    for (int k = 0; k < 9; ++k) map.keyframes.add(k, Quat::Identity(), Vec3(Scalar(3), 0, 0));
    map.keyframes.remove(0);
    keep_place();
  }

  TestImage seen_from(const Vec3& c_W, const Texture& texture) const {
    return TestImage(kWidth, kHeight, [&](int x, int y) {
      return texture.at(x + 260 * static_cast<double>(c_W.x() / kDepth),
                        y + 260 * static_cast<double>(c_W.y() / kDepth));
    });
  }
  void keep_place() {
    const TestImage image = seen_from(Vec3::Zero(), wall);
    TEST_ASSERT_TRUE(images.begin_frame(image.view()));
    KeptPlace place;
    place.id = 1;
    place.covariance = Mat6::Identity() * Scalar(1e-6);
    for (int i = 0; i < kPoints; ++i) {
      const Vec2 pixel(static_cast<Scalar>(110 + 40 * (i % 5)), static_cast<Scalar>(45 + 48 * (i / 5)));
      Vec3 ray;
      SourcePatch patch;
      PlacePoint point;
      TEST_ASSERT_TRUE(unproject(settings.camera, pixel, &ray));
      TEST_ASSERT_TRUE(extract_source(images.tracker().pyramid(), pixel, &patch));
      point.id = static_cast<std::uint32_t>(i + 1);
      point.observations = 20;
      set_place_point(ray * (kDepth / ray.z()), Mat3::Identity() * Scalar(1e-6), Quat::Identity(), Vec3::Zero(), patch,
                      &point);
      add_point(point, &place);
    }
    place.depth = kDepth;
    TEST_ASSERT_TRUE(map.places.keep(place) >= 0);
  }
  /// What the finder says of a view whose camera is at c_W, with a window that has it elsewhere by its drift.
  LoopClosure look(const Vec3& c_W, const Vec3& drift, const Texture& texture) {
    const TestImage image = seen_from(c_W, texture);
    frame.begin(frame.report.t_ns + 33333333);
    TEST_ASSERT_TRUE(images.begin_frame(image.view()));
    Body body;
    body.p_W = c_W + drift;
    motion.set(body, Mat6(Mat6::Identity() * Scalar(1e-6)), Scalar(0.01), Scalar(0.01));
    return finder.look(motion, kDepth, chain);
  }
};

const Vec3 kDrift(Scalar(0.04), Scalar(-0.03), Scalar(0.02)), kFirst(Scalar(0.1), 0, 0), kSecond(Scalar(0.4), 0, 0);

void test_two_views_of_the_place_should_tell_the_drift() {
  Bench bench;
  TEST_ASSERT_EQUAL_INT(0, bench.look(kFirst, kDrift, bench.wall).place);
  const LoopClosure loop = bench.look(kSecond, kDrift, bench.wall);
  TEST_ASSERT_EQUAL_INT(1, loop.place);
  TEST_ASSERT_TRUE((loop.x.segment<3>(3).cast<Scalar>() + kDrift).norm() < Scalar(0.01));
  const auto variance = [](const SimilarityCovariance& C) { return C.diagonal().segment<3>(3).sum(); };
  TEST_ASSERT_TRUE(variance(loop.posterior) < 0.1 * variance(loop.prior));
  // Once.
  TEST_ASSERT_EQUAL_INT(0, bench.look(kSecond, kDrift, bench.wall).place);
}

void test_a_view_that_differs_little_from_the_last_should_not_be_compared() {
  Bench bench;
  bench.look(kFirst, kDrift, bench.wall);
  TEST_ASSERT_EQUAL_INT(0, bench.look(kFirst + Vec3(Scalar(0.1), 0, 0), kDrift, bench.wall).place);
}

void test_another_wall_should_not_be_taken_for_the_place() {
  Bench bench;
  for (int k = 0; k < 6; ++k)
    TEST_ASSERT_EQUAL_INT(0,
                          bench.look(Vec3(Scalar(0.3) * static_cast<Scalar>(k % 2), 0, 0), kDrift, bench.other).place);
}

/// Twelve sigma away, where drift does not explain it.
void test_the_wall_farther_away_than_drift_allows_should_not_be_taken() {
  Bench bench;
  const Vec3 far = 12 * kSigma * Vec3::UnitX();
  for (int k = 0; k < 4; ++k)
    TEST_ASSERT_EQUAL_INT(0, bench.look(k % 2 == 0 ? kFirst : kSecond, far, bench.wall).place);
}

void test_without_places_nothing_should_be_looked_for() {
  Bench bench;
  bench.map.places.clear();
  TEST_ASSERT_EQUAL_INT(0, bench.look(kFirst, kDrift, bench.wall).place);
  TEST_ASSERT_EQUAL_INT(0, bench.look(kSecond, kDrift, bench.wall).place);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_two_views_of_the_place_should_tell_the_drift);
  RUN_TEST(test_a_view_that_differs_little_from_the_last_should_not_be_compared);
  RUN_TEST(test_another_wall_should_not_be_taken_for_the_place);
  RUN_TEST(test_the_wall_farther_away_than_drift_allows_should_not_be_taken);
  RUN_TEST(test_without_places_nothing_should_be_looked_for);
  return UNITY_END();
}
