// How sharp an image is, and whether it is as sharp as those before it.
#include <algorithm>
#include <utility>

#include "belief/sharpness_belief.h"
#include "support/bounds.h"
#include "support/textured_images.h"
#include "unity.h"
#include "vision/sharpness.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kWidth = 160, kHeight = 120;

TestImage textured_image(SeededRandom* random) {
  const Texture texture(random, 4, 60);
  return TestImage(kWidth, kHeight, [&](int x, int y) { return texture.at(x, y); });
}

/// Log sharpness of an image; fails where there is none.
Scalar sharpness_of(const TestImage& image) {
  TestArena arena;
  Pyramid pyramid;
  TEST_ASSERT_TRUE(pyramid.layout(*arena, image.view().width, image.view().height, 4));
  pyramid.build(image.view());
  Scalar sharpness = 0;
  TEST_ASSERT_TRUE(measure_sharpness(pyramid, &sharpness));
  return sharpness;
}

/// The mean of `length` pixels along (dx, dy).
TestImage smeared(const TestImage& image, int length, int dx, int dy) {
  TestImage out = image;
  const ImageView from = image.view();
  for (int y = 0; y < from.height; ++y)
    for (int x = 0; x < from.width; ++x) {
      int sum = 0;
      for (int k = 0; k < length; ++k) {
        const int at_x = std::clamp(x + dx * (k - length / 2), 0, from.width - 1);
        const int at_y = std::clamp(y + dy * (k - length / 2), 0, from.height - 1);
        sum += from.at(at_x, at_y);
      }
      out.pixels[static_cast<std::size_t>(y * from.width + x)] = static_cast<std::uint8_t>(sum / length);
    }
  return out;
}

void test_smear_in_any_direction_should_take_from_sharpness() {
  SeededRandom random(71);
  double sum = 0;
  int count = 0;
  for (int trial = 0; trial < 10; ++trial) {
    const TestImage image = textured_image(&random);
    const Scalar sharp = sharpness_of(image);
    for (const auto& along : {std::pair<int, int>{1, 0}, {0, 1}, {1, 1}, {1, -1}}) {
      const double taken = static_cast<double>(sharp - sharpness_of(smeared(image, 9, along.first, along.second)));
      TEST_ASSERT_TRUE(taken > 0.1);
      sum += taken;
      ++count;
    }
  }
  TEST_ASSERT_TRUE(sum > 0.4 * count);
}

void test_sharpness_should_not_depend_on_light() {
  SeededRandom random(72);
  const TestImage image = textured_image(&random);
  TestImage dim = image;
  for (std::uint8_t& pixel : dim.pixels) pixel = static_cast<std::uint8_t>(20 + pixel / 2);
  TEST_ASSERT_DOUBLE_WITHIN(0.03, static_cast<double>(sharpness_of(image)), static_cast<double>(sharpness_of(dim)));
}

void test_an_image_without_gradients_should_have_no_sharpness() {
  TestArena arena;
  Pyramid pyramid;
  Scalar sharpness = 7;
  TEST_ASSERT_TRUE(pyramid.layout(*arena, kWidth, kHeight, 4));
  const std::vector<std::uint8_t> grey(static_cast<std::size_t>(kWidth * kHeight), 90);
  pyramid.build(ImageView{grey.data(), kWidth, kHeight, kWidth});
  TEST_ASSERT_FALSE(measure_sharpness(pyramid, &sharpness));
  TestArena small;
  Pyramid levels;
  TEST_ASSERT_TRUE(levels.layout(*small, 32, 32, 4));  // which has three
  SeededRandom random(73);
  const TestImage noise = noise_image(32, 32, &random);
  levels.build(noise.view());
  TEST_ASSERT_FALSE(measure_sharpness(levels, &sharpness));
  TEST_ASSERT_EQUAL_DOUBLE(7.0, static_cast<double>(sharpness));
}

void test_an_image_below_its_film_should_be_less_sharp() {
  SeededRandom random(74);
  SharpnessBelief belief;
  belief.init();
  belief.note(Scalar(-9));
  TEST_ASSERT_EQUAL_DOUBLE(1.0, static_cast<double>(belief.as_sharp()));  // nothing to compare with
  belief.note_none();
  for (int frame = 0; frame < 30; ++frame) {
    belief.note(static_cast<Scalar>(-1.3 + 0.1 * random.normal()));
    belief.learn();
  }
  belief.note(Scalar(-1.3));
  TEST_ASSERT_TRUE(belief.as_sharp() > Scalar(0.95));
  belief.note(Scalar(-0.5));
  TEST_ASSERT_EQUAL_DOUBLE(1.0, static_cast<double>(belief.as_sharp()));
  belief.note(Scalar(-1.9));
  TEST_ASSERT_TRUE(belief.as_sharp() < Scalar(0.05));
  belief.note_none();
  TEST_ASSERT_EQUAL_DOUBLE(1.0, static_cast<double>(belief.as_sharp()));
  belief.learn();  // of a frame without an image nothing is learned
  belief.note(Scalar(-1.3));
  TEST_ASSERT_TRUE(belief.as_sharp() > Scalar(0.95));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_smear_in_any_direction_should_take_from_sharpness);
  RUN_TEST(test_sharpness_should_not_depend_on_light);
  RUN_TEST(test_an_image_without_gradients_should_have_no_sharpness);
  RUN_TEST(test_an_image_below_its_film_should_be_less_sharp);
  return UNITY_END();
}
