// Which of the visible features are measured when there are more than a frame takes: those that this view can be compared with first.
// Where new features are taken when not every cell of the image gets one: where a proven plane is.
#include "filter_slam/features/image_front_end.h"
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
  ImageFrontEnd images{settings, *filter, map, frame, features, update, tracking.belief(), noise};
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
    TEST_ASSERT_TRUE(images.layout(*arena, kMost));
    map.init();
    frame.init();
    images.init();
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
    TEST_ASSERT_TRUE(images.search().remember(entry, pixel, view));
    map.features[entry].observations = map.features[entry].attempts = observations;
    return entry;
  }
};

void test_features_of_another_side_should_not_take_the_place_of_new_ones() {
  Bench bench;
  for (int i = 0; i < 2 * kMost; ++i) bench.add(100, i % 2 == 0 ? Bench::First::kBehind : Bench::First::kAfar);
  int added[3];
  for (int& entry : added) entry = bench.add(1, Bench::First::kHere);
  TEST_ASSERT_EQUAL_INT(kMost, bench.images.search().list_visible());
  for (int i = 0; i < 3; ++i) TEST_ASSERT_EQUAL_INT(added[i], bench.update.candidate(i).feature);
  for (int i = 3; i < kMost; ++i)
    TEST_ASSERT_EQUAL_INT(100, bench.map.features[bench.update.candidate(i).feature].observations);
}

void test_proven_features_should_be_measured_first() {
  Bench bench;
  for (int i = 0; i < kMost; ++i) bench.add(1, Bench::First::kHere);
  const int proven = bench.add(10, Bench::First::kHere), better = bench.add(30, Bench::First::kHere);
  TEST_ASSERT_EQUAL_INT(kMost, bench.images.search().list_visible());
  TEST_ASSERT_EQUAL_INT(better, bench.update.candidate(0).feature);
  TEST_ASSERT_EQUAL_INT(proven, bench.update.candidate(1).feature);
}

/// How many of ten new features lie in the left quarter of the image, where a plane of this age is seen.
int new_features_on_the_left(int age) {
  Bench bench;
  Settings& settings = bench.settings;
  settings.planes = true;
  settings.plane_min_points = 7;
  settings.features_in_view = 10;
  settings.inverse_depth_relative_sigma = Scalar(0.5);
  const Body body = bench.filter->state().body;
  const auto at = [&](Scalar u, Scalar v) {
    Vec3 ray_C;
    TEST_ASSERT_TRUE(unproject(settings.camera, Vec2(u, v), &ray_C));
    return Vec3(2 * ray_C / ray_C.z());
  };
  const Scalar right = static_cast<Scalar>(settings.camera.width) / 4,
               low = static_cast<Scalar>(settings.camera.height - 1);
  const Vec3 corner = at(0, 0);
  PlaneFrame frame;
  frame.o_W = body.p_W + body.q_WC * corner;
  // The normal is towards the camera, so that y goes up in the image.
  frame.R_WP = body.q_WC.toRotationMatrix() * Eigen::DiagonalMatrix<Scalar, 3>(1, -1, -1);
  const int slot = bench.filter->add_known_plane(frame, Mat3::Identity() * Scalar(1e-6), Scalar(0));
  TEST_ASSERT_TRUE(slot >= 0);
  PlaneEntry& plane = bench.map.planes[bench.map.planes.add(slot)];
  plane.age = age;
  plane.max_points = 8;
  const Vec2 outline[4] = {Vec2(0, 0), Vec2(at(right, 0).x() - corner.x(), 0), Vec2(0, corner.y() - at(0, low).y()),
                           Vec2(at(right, 0).x() - corner.x(), corner.y() - at(0, low).y())};
  extend_outline(&plane.seen, outline, 4);
  bench.images.corners().add();
  int added = 0, left = 0;
  for (int t = 0; t < bench.frame.match_count(); ++t) {
    ++added;
    if (bench.frame.match(t).measured.x() < right) ++left;
  }
  TEST_ASSERT_EQUAL_INT(10, added);
  return left;
}

void test_new_features_should_be_taken_on_a_proven_plane_first() {
  TEST_ASSERT_EQUAL_INT(10, new_features_on_the_left(10));
  TEST_ASSERT_TRUE(new_features_on_the_left(0) <= 5);
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_features_of_another_side_should_not_take_the_place_of_new_ones);
  RUN_TEST(test_proven_features_should_be_measured_first);
  RUN_TEST(test_new_features_should_be_taken_on_a_proven_plane_first);
  return UNITY_END();
}
