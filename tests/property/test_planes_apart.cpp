// Known planes that nothing in the map has been compared with: they tell nothing of the gauge, until the map gets its size from them.
#include "same.h"
#include "support/plane_scene.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kAll = 7;

PlaneFrame some_frame() {
  PlaneFrame frame;
  frame.o_W = Vec3(Scalar(2), Scalar(-1), Scalar(6));
  return frame;
}

void spread_with_gauge(PlaneScene& scene, SeededRandom& random) {
  const Dense N = scene.filter.gauge();
  scene.filter.set_P(N * random_covariance(random, kAll, 0.3) * N.transpose() +
                     random_covariance(random, scene.filter.dim(), 0.02));
}

void test_a_plane_apart_should_tell_nothing_and_one_that_is_not_should() {
  SeededRandom random(95);
  PlaneScene scene(random, 0.01);
  spread_with_gauge(scene, random);
  scene.filter->open_scale(Scalar(1), Vec3(1, 2, 3));
  const Dense before = scene.filter.gauge_information();
  TEST_ASSERT_TRUE(scene.filter->add_known_plane(some_frame(), Mat3::Identity() * Scalar(1e-4), Scalar(0.01), true) >=
                   0);
  TEST_ASSERT_TRUE(scene.filter->apart().any());
  TEST_ASSERT_TRUE(largest(scene.filter.gauge_information() - before) < 1e-9 * largest(before));
  scene.filter->join_planes_apart(Scalar(1), Vec3::Zero());
  TEST_ASSERT_FALSE(scene.filter->apart().any());
  const Dense now = scene.filter.gauge_information();
  for (int i = 0; i < kAll; ++i) TEST_ASSERT_TRUE(now(i, i) > before(i, i) * (1 - 1e-6));
  TEST_ASSERT_TRUE(now(2, 2) > before(2, 2) * 1.01);  // along its normal
}

/// The map and what is known of it within itself are the same in other lengths; the plane stays where the plan has it.
void test_a_map_that_gets_its_size_should_show_the_same_pixels() {
  SeededRandom random(96);
  PlaneScene scene(random, 0.01);
  TEST_ASSERT_EQUAL_INT(8, scene.fold_all(PlaneScene::drop()));
  const int camera = scene.filter->add_reference_camera();
  scene.filter->pin(camera);
  spread_with_gauge(scene, random);
  const int plane = scene.filter->add_known_plane(some_frame(), Mat3::Identity() * Scalar(1e-4), Scalar(0.01), true);
  std::vector<int> slots = scene.far_off;
  for (const auto* more : {&scene.on_wall, &scene.beside, &scene.second_wall})
    slots.insert(slots.end(), more->begin(), more->end());
  struct Seen {
    int slot;
    Vec3 p_W;
    PixelMeasurement z;
    Mat2 S;
  };
  std::vector<Seen> seen;
  for (const int slot : slots) {
    Seen s{slot, scene.filter->point(slot), {}, Mat2::Zero()};
    if (!scene.filter->predict_pixel(pinhole_camera(), slot, &s.z)) continue;
    s.S = scene.filter->innovation(s.z);
    seen.push_back(s);
  }
  TEST_ASSERT_GREATER_THAN_INT(10, static_cast<int>(seen.size()));
  const Vec3 pivot(Scalar(0.7), Scalar(-0.4), Scalar(1.2)), c_W = scene.filter->state().body.p_W;
  const Scalar scale = Scalar(2.5);
  scene.filter->join_planes_apart(scale, pivot);
  TEST_ASSERT_TRUE((scene.filter->state().body.p_W - (pivot + scale * (c_W - pivot))).norm() < Scalar(1e-12));
  for (const Seen& s : seen) {
    TEST_ASSERT_TRUE((scene.filter->point(s.slot) - (pivot + scale * (s.p_W - pivot))).norm() < Scalar(1e-9));
    PixelMeasurement z;
    TEST_ASSERT_TRUE(scene.filter->predict_pixel(pinhole_camera(), s.slot, &z));
    TEST_ASSERT_TRUE((z.predicted - s.z.predicted).norm() < Scalar(1e-8));
    const Mat2 S = scene.filter->innovation(z);
    TEST_ASSERT_TRUE((S - s.S).norm() < Scalar(1e-8) * s.S.norm());
  }
  const Block& block = scene.filter->state().block[plane];
  TEST_ASSERT_SAME(BlockKind::kPlane, block.kind);
  TEST_ASSERT_SAME(Scalar(0), (scene.filter->state().frame_of(block).o_W - some_frame().o_W).norm());
  TEST_ASSERT_TRUE(std::abs(scene.filter->block_variance(plane, 2) - Scalar(1e-4)) < Scalar(1e-12));
}

/// An open scale about a place leaves a camera that is there where it is.
void test_the_scale_should_be_open_about_its_pivot() {
  SeededRandom random(97);
  PlaneScene scene(random, 0.01);
  const Vec3 c_W = scene.filter->state().body.p_W;
  Scalar before[36], at_camera[36], elsewhere[36];
  scene.filter->body_covariance(6, before);
  scene.filter->open_scale(Scalar(1), c_W);
  scene.filter->body_covariance(6, at_camera);
  for (int i = 0; i < 36; ++i) TEST_ASSERT_TRUE(std::abs(at_camera[i] - before[i]) < Scalar(1e-12));
  scene.filter->open_scale(Scalar(1), Vec3(c_W + Vec3(0, 0, 2)));
  scene.filter->body_covariance(6, elsewhere);
  TEST_ASSERT_TRUE(std::abs(elsewhere[35] - before[35] - Scalar(4)) < Scalar(1e-9));
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_a_plane_apart_should_tell_nothing_and_one_that_is_not_should);
  RUN_TEST(test_a_map_that_gets_its_size_should_show_the_same_pixels);
  RUN_TEST(test_the_scale_should_be_open_about_its_pivot);
  return UNITY_END();
}
