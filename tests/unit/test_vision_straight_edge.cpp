// A ragged straight edge is told from a corner: at every angle and contrast, and with noise.
#include <cmath>

#include "support/textured_images.h"
#include "unity.h"
#include "vision/corners.h"
#include "vision/straight_edge.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kSize = 60, kMiddle = 30;

/// A step between two grey levels through the middle at this angle, averaged over each pixel.
TestImage edge(double angle, double low, double high, double noise, SeededRandom* random) {
  constexpr int kParts = 4;
  return TestImage(kSize, kSize, [&](int x, int y) {
    int bright = 0;
    for (int k = 0; k < kParts * kParts; ++k) {
      const double u = x - kMiddle + (k % kParts + 0.5) / kParts, v = y - kMiddle + (k / kParts + 0.5) / kParts;
      bright += u * std::sin(angle) > v * std::cos(angle) ? 1 : 0;
    }
    return low + (high - low) * bright / (kParts * kParts) + noise * random->normal();
  });
}

void test_straight_edge_should_be_told_when_sampling_or_noise_makes_it_ragged() {
  SeededRandom random(5);
  int corners = 0;
  for (int degrees = 1; degrees < 180; degrees += 2) {
    for (double high : {120.0, 180.0, 255.0}) {
      const TestImage image = edge(degrees * 3.14159265 / 180, 60, high, 2, &random);
      for (int y = 10; y < kSize - 10; ++y)
        for (int x = 10; x < kSize - 10; ++x) {
          if (min_eigenvalue(image.view(), x, y) < 12) continue;
          ++corners;
          TEST_ASSERT_TRUE(is_on_straight_edge(image.view(), x, y));
        }
    }
  }
  TEST_ASSERT_GREATER_THAN_INT(1000, corners);
}

void test_straight_edge_should_not_be_told_when_two_edges_meet() {
  SeededRandom random(6);
  for (int degrees = 0; degrees < 360; degrees += 7) {
    for (double opening : {45.0, 90.0, 135.0, 225.0, 270.0}) {
      const double from = degrees * 3.14159265 / 180, half = opening * 3.14159265 / 360;
      const TestImage image(kSize, kSize, [&](int x, int y) {
        const double at = std::remainder(std::atan2(y - kMiddle + 0.1, x - kMiddle + 0.1) - from, 2 * 3.14159265);
        return (std::fabs(at) < half ? 200 : 60) + 2 * random.normal();
      });
      TEST_ASSERT_FALSE(is_on_straight_edge(image.view(), kMiddle, kMiddle));
    }
  }
}

void test_straight_edge_should_not_be_told_when_there_is_a_dot_a_line_that_ends_or_nothing() {
  SeededRandom random(7);
  const TestImage dot(kSize, kSize, [&](int x, int y) {
    return (std::hypot(x - kMiddle, y - kMiddle) < 2.5 ? 200 : 60) + 2 * random.normal();
  });
  TEST_ASSERT_FALSE(is_on_straight_edge(dot.view(), kMiddle, kMiddle));
  const TestImage line(kSize, kSize, [&](int x, int y) {
    return (std::abs(y - kMiddle) < 2 && x < kMiddle ? 200 : 60) + 2 * random.normal();
  });
  TEST_ASSERT_FALSE(is_on_straight_edge(line.view(), kMiddle, kMiddle));
  TEST_ASSERT_TRUE(is_on_straight_edge(line.view(), kMiddle - 15, kMiddle));
  const TestImage flat(kSize, kSize, [](int, int) { return 100; });
  TEST_ASSERT_FALSE(is_on_straight_edge(flat.view(), kMiddle, kMiddle));
}

void test_straight_edge_should_not_be_told_when_the_image_ends_too_near() {
  SeededRandom random(8);
  const TestImage image = edge(0.5 * 3.14159265, 60, 200, 0, &random);
  TEST_ASSERT_TRUE(is_on_straight_edge(image.view(), kMiddle, kStraightEdgeBorder));
  TEST_ASSERT_FALSE(is_on_straight_edge(image.view(), kMiddle, kStraightEdgeBorder - 1));
  TEST_ASSERT_TRUE(is_on_straight_edge(image.view(), kMiddle, kSize - 1 - kStraightEdgeBorder));
  TEST_ASSERT_FALSE(is_on_straight_edge(image.view(), kMiddle, kSize - kStraightEdgeBorder));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_straight_edge_should_be_told_when_sampling_or_noise_makes_it_ragged);
  RUN_TEST(test_straight_edge_should_not_be_told_when_two_edges_meet);
  RUN_TEST(test_straight_edge_should_not_be_told_when_there_is_a_dot_a_line_that_ends_or_nothing);
  RUN_TEST(test_straight_edge_should_not_be_told_when_the_image_ends_too_near);
  return UNITY_END();
}
