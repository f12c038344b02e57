// How a camera has turned between two images: against the rotation by which one was rendered from the other.
#include "geometry/so3.h"
#include "same.h"
#include "support/filter_cases.h"
#include "support/panorama.h"
#include "support/test_cameras.h"
#include "track/image_rotation.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kWidth = Panorama::kWidth, kHeight = Panorama::kHeight;

void test_pixels_of_a_thumbnail_should_come_back() {
  const Camera camera = test_camera(CameraModel::kPinhole, kWidth, kHeight, 260, 260, 159.5, 119.5);
  const Vec2 corner = from_thumbnail(camera, Vec2(0, 0));
  TEST_ASSERT_TRUE((corner - Vec2(Scalar(3.5), Scalar(3.5))).norm() < Scalar(1e-5));  // the middle of 8 x 8 pixels
  TEST_ASSERT_TRUE((to_thumbnail(camera, corner)).norm() < Scalar(1e-5));
}

/// In every lens, turns of up to 11 degrees about all axes, and another exposure.
void test_a_turn_should_be_found_to_a_fraction_of_a_pixel_of_the_thumbnail() {
  SeededRandom random(131);
  Panorama panorama(random);
  double worst = 0;
  for (int trial = 0; trial < 24; ++trial) {
    const Camera camera = trial % 2 == 0
                              ? test_camera(CameraModel::kPinhole, kWidth, kHeight, 260, 260, 159.5, 119.5)
                              : test_camera(CameraModel::kEquidistant, kWidth, kHeight, 180, 180, 159.5, 119.5);
    const Vec3 turn(static_cast<Scalar>(random.uniform(-0.12, 0.12)), static_cast<Scalar>(random.uniform(-0.15, 0.15)),
                    static_cast<Scalar>(random.uniform(-0.12, 0.12)));
    const Quat before_W = exp_so3(Vec3(Scalar(0.1), Scalar(0.2 * (trial - 12)), 0));
    const Thumbnail before = panorama.thumbnail(camera, before_W);
    const Thumbnail now = panorama.thumbnail(camera, before_W * exp_so3(turn), 0.8, 20);
    Quat found;
    TEST_ASSERT_TRUE(find_rotation(camera, before, now, &found));
    worst = std::fmax(worst, static_cast<double>(log_so3(found * exp_so3(turn).conjugate()).norm()));
  }
  std::printf("off by %.4f rad at most; a pixel of the thumbnail is 0.03\n", worst);
  TEST_ASSERT_TRUE(worst < 0.006);
}

void test_no_turn_should_be_found_between_other_places_or_without_content() {
  SeededRandom random(132);
  Panorama panorama(random), elsewhere(random);
  const Camera camera = test_camera(CameraModel::kPinhole, kWidth, kHeight, 260, 260, 159.5, 119.5);
  const Quat q = Quat::Identity();
  const Thumbnail here = panorama.thumbnail(camera, q);
  Thumbnail flat;
  for (std::uint8_t& p : flat.pixels) p = 90;
  Quat found(Scalar(0.5), Scalar(0.5), Scalar(0.5), Scalar(0.5));
  TEST_ASSERT_FALSE(find_rotation(camera, here, elsewhere.thumbnail(camera, q), &found));
  TEST_ASSERT_FALSE(find_rotation(camera, flat, here, &found));
  TEST_ASSERT_FALSE(find_rotation(camera, here, flat, &found));
  TEST_ASSERT_SAME(Scalar(0.5), found.w());
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_pixels_of_a_thumbnail_should_come_back);
  RUN_TEST(test_a_turn_should_be_found_to_a_fraction_of_a_pixel_of_the_thumbnail);
  RUN_TEST(test_no_turn_should_be_found_between_other_places_or_without_content);
  return UNITY_END();
}
