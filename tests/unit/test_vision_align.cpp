// Sub-pixel alignment of patches.
#include <cstring>
#include <limits>

#include "support/bounds.h"
#include "support/textured_images.h"
#include "unity.h"
#include "vision/align.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

bool template_at(const ImageView& image, int x, int y, AlignTemplate* out) {
  float window[kWarpSize * kWarpSize];
  for (int j = 0; j < kWarpSize; ++j) {
    for (int i = 0; i < kWarpSize; ++i) {
      window[j * kWarpSize + i] = static_cast<float>(image.at(x - kWarpSize / 2 + i, y - kWarpSize / 2 + j));
    }
  }
  return make_align_template(window, out);
}

struct Outcome {
  int converged = 0, tried = 0;
  double rms_px = 0, worst_px = 0;
  double rms_grey = 0, least_zncc = 1, gain = 0, nees = 0;
};

/// Many places of one texture, shown again with a shift, gain, bias and noise in both images.
Outcome align_all(std::uint64_t seed, double gain, double bias, double sigma) {
  SeededRandom random(seed);
  const Texture texture(&random, 9, 40);
  Outcome out;
  for (int k = 0; k < 8; ++k) {
    const double dx = random.uniform(-1.4, 1.4), dy = random.uniform(-1.4, 1.4);
    const TestImage before(120, 120, [&](int x, int y) { return texture.at(x, y) + sigma * random.normal(); });
    const TestImage after(
        120, 120, [&](int x, int y) { return gain * texture.at(x - dx, y - dy) + bias + sigma * random.normal(); });
    for (int y = 12; y < 108; y += 9) {
      for (int x = 12; x < 108; x += 9) {
        AlignTemplate pattern;
        if (!template_at(before.view(), x, y, &pattern)) continue;
        ++out.tried;
        const AlignResult found = align(after.view(), pattern, Vec2(x, y));
        if (!found.converged) continue;
        ++out.converged;
        const double ex = static_cast<double>(found.position.x()) - x - dx;
        const double ey = static_cast<double>(found.position.y()) - y - dy;
        out.rms_px += ex * ex + ey * ey;
        out.worst_px = std::fmax(out.worst_px, std::hypot(ex, ey));
        out.rms_grey += static_cast<double>(found.rms * found.rms);
        out.least_zncc = std::fmin(out.least_zncc, static_cast<double>(found.zncc));
        out.gain += static_cast<double>(found.gain);
        const Eigen::Vector2d error(ex, ey);
        out.nees += error.dot(found.covariance().cast<double>().inverse() * error);
      }
    }
  }
  out.rms_px = std::sqrt(out.rms_px / out.converged);
  out.rms_grey = std::sqrt(out.rms_grey / out.converged);
  out.gain /= out.converged;
  out.nees /= out.converged;
  std::printf(
      "gain %g bias %g sigma %g: %d of %d converged, rms %.4f px, worst %.4f px, %.2f grey, zncc %.4f, nees %.2f\n",
      gain, bias, sigma, out.converged, out.tried, out.rms_px, out.worst_px, out.rms_grey, out.least_zncc, out.nees);
  return out;
}

void test_alignment_should_be_exact_to_a_fiftieth_pixel_when_there_is_no_noise() {
  const Outcome o = align_all(41, 1, 0, 0);
  TEST_ASSERT_GREATER_THAN_INT(o.tried * 98 / 100, o.converged);
  EXPECT_BELOW(0.02, o.rms_px);
  EXPECT_NOT_BELOW(0.99, o.least_zncc);
}

void test_alignment_should_be_good_to_a_tenth_pixel_when_noise_is_two_grey_levels() {
  const Outcome o = align_all(42, 1, 0, 2);
  TEST_ASSERT_GREATER_THAN_INT(o.tried * 97 / 100, o.converged);
  EXPECT_BELOW(0.1, o.rms_px);
  TEST_ASSERT_DOUBLE_WITHIN(0.3, 2 * std::sqrt(2.0), o.rms_grey);  // the noise of both images
}

void test_covariance_should_tell_the_error_when_noise_is_not_known() {
  for (const double sigma : {2.0, 3.0, 5.0}) {
    const Outcome o = align_all(43, 0.7, 20, sigma);
    TEST_ASSERT_DOUBLE_WITHIN(0.7, 2.0, o.nees);
  }
}

void test_alignment_should_not_care_when_gain_and_bias_change() {
  const Outcome o = align_all(44, 0.5, 60, 0);
  TEST_ASSERT_GREATER_THAN_INT(o.tried * 98 / 100, o.converged);
  EXPECT_BELOW(0.03, o.rms_px);
  TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.5, o.gain);
}

void test_template_should_be_refused_when_it_has_no_corner() {
  AlignTemplate pattern;
  TEST_ASSERT_FALSE(template_at(TestImage(32, 32).view(), 16, 16, &pattern));
  const TestImage edge(32, 32, [](int x, int) { return 128 + 80 * std::sin(0.5 * x); });
  TEST_ASSERT_FALSE(template_at(edge.view(), 16, 16, &pattern));
}

void test_alignment_should_stay_near_its_start_when_something_else_is_there() {
  SeededRandom random(45);
  const TestImage before = noise_image(64, 64, &random);
  const TestImage after = noise_image(64, 64, &random);
  for (int k = 0; k < 200; ++k) {
    const int x = static_cast<int>(random.uniform(8, 56)), y = static_cast<int>(random.uniform(8, 56));
    AlignTemplate pattern;
    TEST_ASSERT_TRUE(template_at(before.view(), x, y, &pattern));
    const AlignResult found = align(after.view(), pattern, Vec2(x, y));
    TEST_ASSERT_LESS_OR_EQUAL_INT(kAlignMaxIterations, found.iterations);
    TEST_ASSERT_TRUE(std::fabs(static_cast<double>(found.position.x()) - x) <= static_cast<double>(kAlignReach));
    TEST_ASSERT_TRUE(std::fabs(static_cast<double>(found.position.y()) - y) <= static_cast<double>(kAlignReach));
    if (found.converged) EXPECT_BELOW(0.9f, found.zncc);
  }
}

void test_alignment_should_stay_in_the_image_when_the_start_is_anywhere() {
  SeededRandom random(46);
  const Texture texture(&random, 9, 30);
  const TestImage image(32, 32, [&](int x, int y) { return texture.at(x, y); });
  AlignTemplate pattern;
  TEST_ASSERT_TRUE(template_at(image.view(), 16, 16, &pattern));
  for (int y = -5; y < 38; ++y) {
    for (int x = -5; x < 38; ++x) {
      const Vec2 start(static_cast<Scalar>(x + 0.37), static_cast<Scalar>(y + 0.81));
      const AlignResult found = align(image.view(), pattern, start);
      const bool fits = x >= 5 && y >= 5 && x < 26 && y < 26;
      TEST_ASSERT_TRUE(fits || !found.converged);
    }
  }
  for (const int corner : {6, 25}) {  // 6: what the template's gradients leave free; the window reaches the last pixels
    TEST_ASSERT_TRUE(template_at(image.view(), corner, corner, &pattern));
    const AlignResult found = align(image.view(), pattern, Vec2(corner, corner));
    TEST_ASSERT_TRUE(found.converged);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, corner, static_cast<double>(found.position.x()));
  }
  const Scalar nan = std::numeric_limits<Scalar>::quiet_NaN();
  TEST_ASSERT_FALSE(align(image.view(), pattern, Vec2(nan, 16)).converged);
  TEST_ASSERT_FALSE(align(image.view(), pattern, Vec2(16, Scalar(1e20))).converged);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_alignment_should_be_exact_to_a_fiftieth_pixel_when_there_is_no_noise);
  RUN_TEST(test_alignment_should_be_good_to_a_tenth_pixel_when_noise_is_two_grey_levels);
  RUN_TEST(test_covariance_should_tell_the_error_when_noise_is_not_known);
  RUN_TEST(test_alignment_should_not_care_when_gain_and_bias_change);
  RUN_TEST(test_template_should_be_refused_when_it_has_no_corner);
  RUN_TEST(test_alignment_should_stay_near_its_start_when_something_else_is_there);
  RUN_TEST(test_alignment_should_stay_in_the_image_when_the_start_is_anywhere);
  return UNITY_END();
}
