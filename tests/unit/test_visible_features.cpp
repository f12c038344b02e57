// Which of the visible features are measured when there are more than a frame takes: those that this view can be compared with first.
#include "slam/image_front_end.h"
#include "support/filter_cases.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kMost = 6;  // that a frame measures

/// A camera before points, with an image of noise.
struct Bench {
  SeededRandom random{7};
  Settings settings;
  TestFilter filter{true};
  Map map;
  Frame frame;
  TrackingState tracking{settings};
  FeatureKeeper features{settings, *filter, map, frame};
  PixelUpdate update{settings, *filter, map, frame, tracking};
  NoiseModel noise;
  ImageFrontEnd images{settings, *filter, map, frame, features, update, noise};
  TestArena arena;
  TestImage image = noise_image(pinhole_camera().width, pinhole_camera().height, &random);

  Bench() {
    settings.camera = pinhole_camera();
    settings.max_features = 40;
    settings.max_observations = kMost;
    settings.gate = 9;
    TEST_ASSERT_TRUE(map.layout(*arena, 40, 2));
    TEST_ASSERT_TRUE(frame.layout(*arena, 40 + kMost));
    TEST_ASSERT_TRUE(update.layout(*arena, kMost));
    TEST_ASSERT_TRUE(images.layout(*arena, settings.camera.width, settings.camera.height, kMost));
    map.init();
    frame.init();
    images.init(settings.camera);
    filter->set_lens(settings.camera, LensPrior());
    filter->set_mean(random_body(random));
    TEST_ASSERT_TRUE(images.begin_frame(image.view()));
  }

  enum class First { kHere, kBehind, kAfar };

  /// A point in view that was seen first from here, from its other side, or from so far that its image was too coarse.
  int add(int observations, First first) {
    const Body body = filter->state().body;
    Vec3 p_W;
    Vec2 pixel;
    do {
      p_W = point_in_view(random, body);
    } while (!project(settings.camera, body.q_WC.conjugate() * (p_W - body.p_W), &pixel) || pixel.x() < 40 ||
             pixel.y() < 40 || pixel.x() > settings.camera.width - 40 || pixel.y() > settings.camera.height - 40);
    const int slot = filter->add_point(p_W, Mat3::Identity() * Scalar(1e-4));
    const int entry = map.features.add(slot);
    filter->set_owner(slot, entry);
    CameraView view{body.q_WC, body.p_W};
    if (first == First::kAfar) view.c_W = p_W - Scalar(6) * (p_W - body.p_W);
    if (first == First::kBehind) {
      const Vec3 up = body.q_WC * Vec3(0, 1, 0);
      view.q_WC = Quat(Eigen::AngleAxis<Scalar>(Scalar(3.14159265), up)) * body.q_WC;
      view.c_W = p_W + (p_W - body.p_W);
    }
    TEST_ASSERT_TRUE(images.remember(entry, pixel, view));
    map.features[entry].observations = map.features[entry].attempts = observations;
    return entry;
  }
};

void test_features_of_another_side_should_not_take_the_place_of_new_ones() {
  Bench bench;
  for (int i = 0; i < 2 * kMost; ++i) bench.add(100, i % 2 == 0 ? Bench::First::kBehind : Bench::First::kAfar);
  int added[3];
  for (int& entry : added) entry = bench.add(1, Bench::First::kHere);
  TEST_ASSERT_EQUAL_INT(kMost, bench.images.list_visible());
  for (int i = 0; i < 3; ++i) TEST_ASSERT_EQUAL_INT(added[i], bench.update.candidate(i).feature);
  for (int i = 3; i < kMost; ++i)
    TEST_ASSERT_EQUAL_INT(100, bench.map.features[bench.update.candidate(i).feature].observations);
}

void test_proven_features_should_be_measured_first() {
  Bench bench;
  for (int i = 0; i < kMost; ++i) bench.add(1, Bench::First::kHere);
  const int proven = bench.add(10, Bench::First::kHere), better = bench.add(30, Bench::First::kHere);
  TEST_ASSERT_EQUAL_INT(kMost, bench.images.list_visible());
  TEST_ASSERT_EQUAL_INT(better, bench.update.candidate(0).feature);
  TEST_ASSERT_EQUAL_INT(proven, bench.update.candidate(1).feature);
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_features_of_another_side_should_not_take_the_place_of_new_ones);
  RUN_TEST(test_proven_features_should_be_measured_first);
  return UNITY_END();
}
