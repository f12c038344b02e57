// Masks of images: which cells are clear, and that corners, thumbnails, rotations and the judgement of a frame leave out what is masked.
#include <cmath>
#include <vector>

#include "geometry/so3.h"
#include "support/panorama.h"
#include "support/test_cameras.h"
#include "support/textured_images.h"
#include "track/image_rotation.h"
#include "unity.h"
#include "vision/blur.h"
#include "vision/corners.h"
#include "vision/image_mask.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

struct Mask {
  TestArena arena;
  ImageMask mask;

  Mask(int width, int height) {
    TEST_ASSERT_TRUE(mask.layout(*arena, width, height));
    mask.init();
  }
  /// Masks all cells that a rectangle reaches into.
  void cover(const Rect& rect) {
    mask.assign([&](const Rect& cell) {
      return cell.x < rect.x + rect.width && rect.x < cell.x + cell.width && cell.y < rect.y + rect.height &&
             rect.y < cell.y + cell.height;
    });
  }
};

void test_a_cell_should_be_masked_as_a_whole_and_no_other() {
  Mask of(50, 33);  // the last cells reach beyond the image
  TEST_ASSERT_EQUAL_INT(13 * 9, of.mask.cells());
  TEST_ASSERT_FALSE(of.mask.has_masked());
  TEST_ASSERT_TRUE(in_use(&of.mask) == nullptr);
  of.cover({21, 14, 1, 1});
  TEST_ASSERT_TRUE(in_use(&of.mask) == &of.mask);
  for (int y = 0; y < 33; ++y)
    for (int x = 0; x < 50; ++x) {
      const bool masked = x / 4 == 5 && y / 4 == 3;
      TEST_ASSERT_EQUAL_INT(!masked, of.mask.is_clear(Rect{x, y, 1, 1}));
      TEST_ASSERT_EQUAL_INT(!masked, of.mask.has_clear(Rect{x, y, 1, 1}));
      TEST_ASSERT_EQUAL_INT(!(x >= 17 && x < 27 && y >= 9 && y < 19),
                            of.mask.is_clear(Vec2(static_cast<Scalar>(x), static_cast<Scalar>(y)), 3));
    }
  TEST_ASSERT_TRUE(of.mask.is_clear(Rect{0, 0, 0, 0}) && !of.mask.has_clear(Rect{20, 12, 4, 4}));
  TEST_ASSERT_FALSE(of.mask.is_clear(Rect{-100, -100, 1000, 1000}));
  TEST_ASSERT_TRUE(of.mask.is_clear(Vec2(Scalar(1e20), Scalar(-1e20)), 5));
  TEST_ASSERT_TRUE(of.mask.is_clear(Vec2(static_cast<Scalar>(NAN), Scalar(1)), 5));
  of.mask.init();
  TEST_ASSERT_FALSE(of.mask.has_masked());
}

void test_corners_should_keep_away_from_what_is_masked() {
  SeededRandom random(7);
  const TestImage image = noise_image(120, 90, &random);
  Mask of(120, 90);
  of.cover({40, 30, 40, 40});
  TestArena arena;
  CornerWorkspace workspace;
  TEST_ASSERT_TRUE(workspace.layout(*arena, 120));
  constexpr int kAll = 2000;
  std::vector<Corner> all(kAll), left(kAll);
  const int before = detect_corners(image.view(), {0, 0, 120, 90}, 40, all.data(), kAll, workspace);
  const int after = detect_corners(image.view(), {0, 0, 120, 90}, 40, left.data(), kAll, workspace, &of.mask);
  int expected = 0;
  for (int i = 0; i < before; ++i) {
    const float x = all[static_cast<std::size_t>(i)].x, y = all[static_cast<std::size_t>(i)].y;
    expected += !(x >= 40 - kMaskMargin && x < 80 + kMaskMargin && y >= 28 - kMaskMargin && y < 72 + kMaskMargin);
  }
  TEST_ASSERT_TRUE(expected > 20 && expected < before);
  TEST_ASSERT_EQUAL_INT(expected, after);
  // Of one alone, it is the best that is left.
  Corner best;
  TEST_ASSERT_EQUAL_INT(1, detect_corners(image.view(), {0, 0, 120, 90}, 40, &best, 1, workspace, &of.mask));
  TEST_ASSERT_TRUE(best.score == left[0].score);
}

/// The lower fifth stands still while the camera turns.
void test_a_turn_should_be_found_beside_a_body_that_stands_still() {
  SeededRandom random(131);
  Panorama panorama(random);
  const Camera camera = test_camera(CameraModel::kPinhole, Panorama::kWidth, Panorama::kHeight, 260, 260, 159.5, 119.5);
  Mask of(Panorama::kWidth, Panorama::kHeight);
  of.cover({0, 192, 320, 48});
  panorama.pyramid.mask = &of.mask;
  ThumbnailMask mask;
  double worst = 0, plain = 0;
  for (int trial = 0; trial < 8; ++trial) {
    const Vec3 turn(0, static_cast<Scalar>(random.uniform(0.05, 0.15)), 0);
    Thumbnail before = panorama.thumbnail(camera, Quat::Identity());
    Thumbnail now = panorama.thumbnail(camera, exp_so3(turn));
    make_thumbnail_mask(panorama.pyramid, &mask);
    TEST_ASSERT_TRUE(mask.has_masked && mask.at(20, 24) && !mask.at(20, 22));
    for (int y = 24; y < Thumbnail::kHeight; ++y)
      for (int x = 0; x < Thumbnail::kWidth; ++x)
        before.pixels[y * Thumbnail::kWidth + x] = now.pixels[y * Thumbnail::kWidth + x] =
            static_cast<std::uint8_t>((x * 37 + y * 91) % 256);
    Quat found = Quat::Identity();
    if (find_rotation(camera, before, now, &found))
      plain = std::fmax(plain, static_cast<double>(log_so3(found * exp_so3(turn).conjugate()).norm()));
    else
      plain = 1;
    TEST_ASSERT_TRUE(find_rotation(camera, before, now, mask, &found));
    worst = std::fmax(worst, static_cast<double>(log_so3(found * exp_so3(turn).conjugate()).norm()));
    TEST_ASSERT_TRUE(correlate(now, now, 0, 0, mask) > 0.99999F);
  }
  std::printf("off by %.4f rad at most with the mask, %.4f without\n", worst, plain);
  TEST_ASSERT_TRUE(worst < 0.006 && plain > 3 * worst);
}

void test_views_should_compare_by_what_is_not_masked_alone() {
  SeededRandom random(133);
  Panorama panorama(random);
  const Camera camera = test_camera(CameraModel::kPinhole, Panorama::kWidth, Panorama::kHeight, 260, 260, 159.5, 119.5);
  const Thumbnail here = panorama.thumbnail(camera, Quat::Identity());
  Thumbnail there = panorama.thumbnail(camera, exp_so3(Vec3(0, Scalar(1.5), 0)));
  Mask of(Panorama::kWidth, Panorama::kHeight);
  of.cover({0, 160, 320, 80});
  panorama.pyramid.mask = &of.mask;
  ThumbnailMask mask;
  make_thumbnail_mask(panorama.pyramid, &mask);
  const float before = correlate(here, there, 2, -1, mask);
  for (int y = 20; y < Thumbnail::kHeight; ++y)
    for (int x = 0; x < Thumbnail::kWidth; ++x)
      there.pixels[y * Thumbnail::kWidth + x] = here.pixels[y * Thumbnail::kWidth + x];
  TEST_ASSERT_TRUE(correlate(here, there, 2, -1, mask) == before);
  of.cover({0, 0, 320, 220});  // less than a quarter is left
  make_thumbnail_mask(panorama.pyramid, &mask);
  TEST_ASSERT_TRUE(correlate(here, here, 0, 0, mask) == 0);
}

void test_a_frame_should_be_judged_by_its_scene() {
  SeededRandom random(9);
  const TestImage noise = noise_image(160, 120, &random);
  TestImage dark(160, 120, [](int, int) { return 5; });
  for (int y = 80; y < 120; ++y)
    for (int x = 0; x < 160; ++x) dark.set(x, y, noise.view().at(x, y));
  Mask of(160, 120);
  of.cover({0, 80, 160, 40});
  TEST_ASSERT_TRUE(judge_frame(frame_statistics(dark.view())) == FrameUse::kUsable);
  TEST_ASSERT_TRUE(judge_frame(frame_statistics(dark.view(), 0, of.mask)) == FrameUse::kDark);
  TEST_ASSERT_TRUE(judge_frame(frame_statistics(noise.view(), 0, of.mask)) == FrameUse::kUsable);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_a_cell_should_be_masked_as_a_whole_and_no_other);
  RUN_TEST(test_corners_should_keep_away_from_what_is_masked);
  RUN_TEST(test_a_turn_should_be_found_beside_a_body_that_stands_still);
  RUN_TEST(test_views_should_compare_by_what_is_not_masked_alone);
  RUN_TEST(test_a_frame_should_be_judged_by_its_scene);
  return UNITY_END();
}
