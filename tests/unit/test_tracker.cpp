// Search for a feature in an image that is smeared.
#include <cstdio>

#include "support/test_cameras.h"
#include "support/textured_images.h"
#include "track/tracker.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kWidth = 320, kHeight = 240;

/// A camera that moves sideways before a wall; the image is shifted by `shift` px, and smeared over `smear` px along x.
struct Wall {
  SeededRandom random;
  Texture texture;
  Camera camera = test_camera(CameraModel::kPinhole, kWidth, kHeight, 300, 300, 159.5, 119.5);
  TestArena arena;
  Tracker tracker;
  Appearance appearance;

  explicit Wall(std::uint64_t seed) : random(seed), texture(&random, 6, 40) {
    TEST_ASSERT_TRUE(tracker.layout(*arena, kWidth, kHeight));
    tracker.init(camera);
  }

  TestImage see(double shift, int smear) {
    return TestImage(kWidth, kHeight, [&](int x, int y) {
      double sum = 0;
      for (int k = 0; k <= smear; ++k) sum += texture.at(x - shift + k - 0.5 * smear, y);
      return sum / (smear + 1) + random.normal();
    });
  }
  void remember(const Vec2& pixel) {
    const TestImage image = see(0, 0);
    TEST_ASSERT_TRUE(tracker.begin_frame(image.view()));
    TEST_ASSERT_TRUE(tracker.remember(pixel, &appearance));
  }
  /// Searches at `sigma` px about where the feature was, in an image that is shifted.
  SearchOutcome search(const Vec2& pixel, double shift, int smear, Scalar sigma) {
    const TestImage image = see(shift, smear);
    tracker.begin_frame(image.view());
    SearchTask task;
    task.appearance = &appearance;
    task.p_W = Vec3((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy, 1);
    task.predicted = pixel;
    task.innovation = Mat2::Identity() * (sigma * sigma);
    return tracker.search(task);
  }
};

/// A smeared image shows the feature at a coarse level, with the noise of that level.
void test_search_should_answer_at_a_coarse_level_when_the_image_is_smeared(void) {
  int sharp = 0, smeared = 0, coarse = 0;
  double squares = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Wall wall(seed);
    const Vec2 pixel(160, 120);
    wall.remember(pixel);
    sharp += wall.search(pixel, 6, 0, 8).found ? 1 : 0;
    const SearchOutcome outcome = wall.search(pixel, 6, 9, 8);
    if (!outcome.found) continue;
    ++smeared;
    coarse += outcome.level_scale > Scalar(1) ? 1 : 0;
    const double dx = static_cast<double>(outcome.pixel.x() - pixel.x() - 6);
    squares +=
        dx * dx / static_cast<double>(outcome.noise(0, 0) + Scalar(0.0625) * outcome.level_scale * outcome.level_scale);
  }
  std::printf("sharp %d, smeared %d (at a coarse level %d), mean square of the error in sigmas %.2f\n", sharp, smeared,
              coarse, squares / smeared);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(18, sharp);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(12, smeared);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(8, coarse);
  TEST_ASSERT_TRUE_MESSAGE(squares < 3 * smeared, "errors beyond their noise");
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_search_should_answer_at_a_coarse_level_when_the_image_is_smeared);
  return UNITY_END();
}
