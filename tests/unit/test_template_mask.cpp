// Masks of templates: the Bayes filter by hand, what teaches nothing, and what is taken from the image.
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

void test_probability_should_follow_bayes() {
  for (const int p : {5, 60, 128, 200, 250})
    for (const double r : {-70.0, -20.0, -12.0, 0.0, 3.0, 15.0, 18.0, 200.0}) {
      const double on = p / 255.0 * density(r, 8), off = (1 - p / 255.0) * density(r, 45);
      double next = on / (on + off);
      next = next < 0.02 ? 0.02 : next > 0.98 ? 0.98 : next;
      TEST_ASSERT_INT_WITHIN(1, static_cast<int>(std::lround(255 * next)),
                             updated_probability(static_cast<std::uint8_t>(p), static_cast<float>(r), kPlane, kOther));
    }
  // By hand: 1/2 and no residual, (1/8) / (1/8 + 1/45) = 0.849.
  TEST_ASSERT_INT_WITHIN(1, 217, updated_probability(128, 0, kPlane, kOther));
}

void test_pixel_should_change_its_side_again() {
  std::uint8_t p = 128;
  for (int k = 0; k < 50; ++k) p = updated_probability(p, 90, kPlane, kOther);
  TEST_ASSERT_EQUAL_INT(5, p);
  int frames = 0;
  for (; p < 128 && frames < 100; ++frames) p = updated_probability(p, 2, kPlane, kOther);
  TEST_ASSERT_TRUE(frames >= 2 && frames <= 5);
  // No numbers beyond the range, whatever comes.
  for (const float r : {1e30f, -1e30f, 0.0f}) {
    const int next = updated_probability(128, r, kPlane, kOther);
    TEST_ASSERT_TRUE(next >= 5 && next <= 250);
  }
}

void test_saturated_pixels_and_explained_residuals_should_teach_nothing() {
  MaskEvidence evidence;
  evidence.residual = 60;
  evidence.valid = true;
  TEST_ASSERT_TRUE(learn_pixel(128, evidence, kPlane, kOther) < 20);
  evidence.slack = 61;
  TEST_ASSERT_EQUAL_INT(128, learn_pixel(128, evidence, kPlane, kOther));
  // Slack excuses what speaks against the plane; what speaks for it counts.
  evidence.residual = 1;
  TEST_ASSERT_TRUE(learn_pixel(128, evidence, kPlane, kOther) > 200);
  evidence.valid = false;
  TEST_ASSERT_EQUAL_INT(128, learn_pixel(128, evidence, kPlane, kOther));
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
        TEST_ASSERT_EQUAL_INT(inside ? 128 : 0, mask[j * side + i]);
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
  RUN_TEST(test_probability_should_follow_bayes);
  RUN_TEST(test_pixel_should_change_its_side_again);
  RUN_TEST(test_saturated_pixels_and_explained_residuals_should_teach_nothing);
  RUN_TEST(test_template_should_know_its_place_and_what_is_outside_of_the_image);
  RUN_TEST(test_image_noise_should_be_that_of_the_image);
  return UNITY_END();
}
