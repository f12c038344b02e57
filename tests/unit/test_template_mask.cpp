// Masks of templates: the Bayes filter by hand, what teaches nothing, and what is taken from the image.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "support/textured_images.h"
#include "unity.h"
#include "vision/template_mask.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr float kPlane = 8, kOther = 45;

double density(double r, double sigma) { return std::exp(-0.5 * r * r / (sigma * sigma)) / sigma; }

double odds_of(double p) { return std::log(p / (1 - p)); }

void test_odds_should_follow_bayes() {
  for (const int byte : {1, 60, 173, 212, 240, 251})
    for (const double r : {-70.0, -20.0, -12.0, 0.0, 3.0, 15.0, 18.0, 200.0}) {
      const double p = 1 / (1 + std::exp(-0.1 * (byte - 212)));
      const double on = p * density(r, 8), off = (1 - p) * density(r, 45);
      const double next = std::clamp(212 + 10 * std::log(on / off), 1.0, 251.0);
      TEST_ASSERT_INT_WITHIN(1, static_cast<int>(std::lround(next)),
                             updated_odds(static_cast<std::uint8_t>(byte), static_cast<float>(r), kPlane, kOther));
    }
  // By hand: 1/2 and no residual, (1/8) / (1/8 + 1/45) = 0.849.
  TEST_ASSERT_INT_WITHIN(1, static_cast<int>(std::lround(212 + 10 * odds_of(0.849))),
                         updated_odds(kMaskUnknown, 0, kPlane, kOther));
  TEST_ASSERT_INT_WITHIN(1, 217, mask_probability(updated_odds(kMaskUnknown, 0, kPlane, kOther)));
}

void test_probability_should_be_zero_only_where_there_is_no_image() {
  TEST_ASSERT_EQUAL_INT(0, mask_probability(0));
  TEST_ASSERT_EQUAL_INT(128, mask_probability(kMaskUnknown));
  TEST_ASSERT_EQUAL_INT(250, mask_probability(kMaskMost));
  TEST_ASSERT_EQUAL_INT(255, mask_probability(kMaskFull));
  for (int byte = 1; byte < 255; ++byte) {
    const int p = mask_probability(static_cast<std::uint8_t>(byte));
    TEST_ASSERT_TRUE(p >= 1 && p <= 255 && p >= mask_probability(static_cast<std::uint8_t>(byte - 1)));
  }
}

void test_pixel_should_leave_at_once_and_come_back_late() {
  std::uint8_t odds = kMaskUnknown;
  for (int k = 0; k < 50; ++k) odds = updated_odds(odds, 0, kPlane, kOther);
  TEST_ASSERT_EQUAL_INT(kMaskMost, odds);
  TEST_ASSERT_TRUE(updated_odds(odds, 30, kPlane, kOther) < kMaskUnknown);
  for (int k = 0; k < 50; ++k) odds = updated_odds(odds, 90, kPlane, kOther);
  TEST_ASSERT_EQUAL_INT(kMaskLeast, odds);
  int frames = 0;
  for (; odds < kMaskUnknown && frames < 100; ++frames) odds = updated_odds(odds, 2, kPlane, kOther);
  TEST_ASSERT_TRUE(frames >= 10 && frames <= 20);
  // No numbers beyond the range, whatever comes.
  for (const float r : {1e30f, -1e30f, 0.0f}) {
    const int next = updated_odds(kMaskUnknown, r, kPlane, kOther);
    TEST_ASSERT_TRUE(next >= kMaskLeast && next <= kMaskMost);
  }
}

void test_saturated_pixels_and_explained_residuals_should_teach_nothing() {
  MaskEvidence evidence;
  evidence.residual = 60;
  evidence.valid = true;
  TEST_ASSERT_TRUE(mask_probability(learn_pixel(kMaskUnknown, evidence, kPlane, kOther)) < 20);
  evidence.slack = 61;
  TEST_ASSERT_EQUAL_INT(kMaskUnknown, learn_pixel(kMaskUnknown, evidence, kPlane, kOther));
  // Slack excuses what speaks against the plane; what speaks for it counts.
  evidence.residual = 1;
  TEST_ASSERT_TRUE(mask_probability(learn_pixel(kMaskUnknown, evidence, kPlane, kOther)) > 200);
  evidence.valid = false;
  TEST_ASSERT_EQUAL_INT(kMaskUnknown, learn_pixel(kMaskUnknown, evidence, kPlane, kOther));
  evidence.valid = true;
  TEST_ASSERT_EQUAL_INT(0, learn_pixel(0, evidence, kPlane, kOther));  // no image there
}

void test_template_should_know_its_place_and_what_is_outside_of_the_image() {
  SeededRandom random(51);
  const Texture texture(&random, 6, 30);
  const TestImage image(80, 60, [&](int x, int y) { return texture.at(x, y); });
  TestArena arena;
  Pyramid pyramid;
  TEST_ASSERT_TRUE(pyramid.layout(*arena, 80, 60, 2));
  pyramid.build(image.view());
  for (const int side : {9, 15, 31}) {
    SourcePatch patch;
    PlanarTemplate shape;
    std::uint8_t mask[31 * 31];
    TEST_ASSERT_TRUE(extract_source(pyramid, Vec2(Scalar(40.3), Scalar(8.2)), &patch));
    begin_template(patch, Vec2(Scalar(40.3), Scalar(8.2)), side, false, 2, &shape, mask);
    TEST_ASSERT_EQUAL_INT(40 - side / 2, shape.left);
    TEST_ASSERT_EQUAL_INT(8 - side / 2, shape.top);
    int there = 0;
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const bool inside = shape.top + j >= 0;
        TEST_ASSERT_EQUAL_INT(inside ? kMaskUnknown : 0, mask[j * side + i]);
        there += inside;
      }
    TEST_ASSERT_FLOAT_WITHIN(0.01f * static_cast<float>(there), 0.502f * static_cast<float>(there), shape.area);
    TEST_ASSERT_TRUE(shape.sigma_plane >= 6 && shape.sigma_plane <= 12);
    TEST_ASSERT_TRUE(shape.sigma_other >= 25 && shape.sigma_other <= 60);
  }
}

void test_image_noise_should_be_that_of_the_image() {
  SeededRandom random(52);
  const Texture texture(&random, 40, 90);
  for (const double sigma : {1.0, 2.0, 4.0}) {
    const TestImage image(160, 120, [&](int x, int y) { return texture.at(x, y) + sigma * random.normal(); });
    TEST_ASSERT_DOUBLE_WITHIN(0.2 * sigma, sigma, static_cast<double>(image_noise(image.view())));
  }
  const TestImage white(160, 120, [](int, int) { return 255.0; });
  TEST_ASSERT_EQUAL_FLOAT(0, image_noise(white.view()));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_odds_should_follow_bayes);
  RUN_TEST(test_probability_should_be_zero_only_where_there_is_no_image);
  RUN_TEST(test_pixel_should_leave_at_once_and_come_back_late);
  RUN_TEST(test_saturated_pixels_and_explained_residuals_should_teach_nothing);
  RUN_TEST(test_template_should_know_its_place_and_what_is_outside_of_the_image);
  RUN_TEST(test_image_noise_should_be_that_of_the_image);
  return UNITY_END();
}
