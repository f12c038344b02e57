// Two images have the same fingerprint only if all their pixels are the same.
#include <cstdint>
#include <vector>

#include "same.h"
#include "support/seeded_random.h"
#include "unity.h"
#include "vision/fingerprint.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

std::vector<std::uint8_t> random_pixels(std::size_t count) {
  SeededRandom random(7);
  std::vector<std::uint8_t> pixels(count);
  for (std::uint8_t& pixel : pixels) pixel = static_cast<std::uint8_t>(random.uniform(0, 256));
  return pixels;
}

void test_fingerprint_should_change_with_each_pixel_and_with_the_size() {
  constexpr int kStride = 80;
  for (const int width : {32, 45, 71}) {
    const int height = 9;
    std::vector<std::uint8_t> pixels = random_pixels(kStride * 9);
    const ImageView image{pixels.data(), width, height, kStride};
    const std::uint64_t before = fingerprint(image);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        std::uint8_t& pixel = pixels[static_cast<std::size_t>(y * kStride + x)];
        pixel = static_cast<std::uint8_t>(pixel ^ 1);
        TEST_ASSERT_TRUE(fingerprint(image) != before);
        pixel = static_cast<std::uint8_t>(pixel ^ 1);
      }
    TEST_ASSERT_SAME(before, fingerprint(image));
    TEST_ASSERT_TRUE(fingerprint({pixels.data(), width - 1, height, kStride}) != before);
    TEST_ASSERT_TRUE(fingerprint({pixels.data(), width, height - 1, kStride}) != before);
  }
}

void test_fingerprint_should_not_depend_on_what_lies_between_the_rows() {
  std::vector<std::uint8_t> pixels = random_pixels(64 * 9);
  const std::uint64_t before = fingerprint({pixels.data(), 45, 9, 64});
  for (int y = 0; y < 9; ++y)
    for (int x = 45; x < 64; ++x) pixels[static_cast<std::size_t>(y * 64 + x)] = 0;
  TEST_ASSERT_SAME(before, fingerprint({pixels.data(), 45, 9, 64}));
}

void test_fingerprint_should_see_when_rows_change_places() {
  std::vector<std::uint8_t> pixels = random_pixels(64 * 9);
  const std::uint64_t before = fingerprint({pixels.data(), 64, 9, 64});
  for (int x = 0; x < 64; ++x) std::swap(pixels[static_cast<std::size_t>(x)], pixels[static_cast<std::size_t>(64 + x)]);
  TEST_ASSERT_TRUE(fingerprint({pixels.data(), 64, 9, 64}) != before);
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_fingerprint_should_change_with_each_pixel_and_with_the_size);
  RUN_TEST(test_fingerprint_should_not_depend_on_what_lies_between_the_rows);
  RUN_TEST(test_fingerprint_should_see_when_rows_change_places);
  return UNITY_END();
}
