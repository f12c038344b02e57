// Pyramid, patches and their warps, and what a frame is worth.
#include <limits>

#include "support/bounds.h"
#include "support/textured_images.h"
#include "unity.h"
#include "vision/blur.h"
#include "vision/patch.h"
#include "vision/pyramid.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

struct Built {
  Built(const TestImage& image, int levels) {
    TEST_ASSERT_TRUE(pyramid.layout(*arena, image.view().width, image.view().height, levels));
    TEST_ASSERT_TRUE((*arena).ok());
    pyramid.build(image.view());
  }
  TestArena arena;
  Pyramid pyramid;
};

void test_halving_should_equal_its_plain_twin_when_sides_are_odd_or_small() {
  SeededRandom random(11);
  for (int width = 1; width < 80; ++width) {
    const TestImage image = noise_image(width, 7, &random);
    const int stride = width / 2 + 3;
    std::vector<std::uint8_t> fast(static_cast<std::size_t>(3 * stride), 77);
    std::vector<std::uint8_t> plain(fast);
    halve(image.view(), fast.data(), stride);
    halve_reference(image.view(), plain.data(), stride);
    TEST_ASSERT_EQUAL_MEMORY(plain.data(), fast.data(), plain.size());
  }
}

void test_levels_should_be_as_many_as_sides_allow_when_more_are_asked_for() {
  TestArena arena;
  Pyramid pyramid;
  TEST_ASSERT_TRUE(pyramid.layout(*arena, 32, 32, 5));
  TEST_ASSERT_EQUAL_INT(3, pyramid.levels);
  TEST_ASSERT_EQUAL_INT(8, pyramid.level[2].width);
  TEST_ASSERT_TRUE(pyramid.layout(*arena, 641, 480, 9));
  TEST_ASSERT_EQUAL_INT(Pyramid::kMaxLevels, pyramid.levels);
  TEST_ASSERT_FALSE(pyramid.layout(*arena, 0, 480, 4));
}

void test_layout_should_take_the_same_bytes_when_it_only_counts() {
  Arena counting;
  Pyramid pyramid;
  TEST_ASSERT_TRUE(pyramid.layout(counting, 640, 480, 4));
  TestArena arena;
  TEST_ASSERT_TRUE(pyramid.layout(*arena, 640, 480, 4));
  TEST_ASSERT_EQUAL_size_t(counting.used(), (*arena).used());
}

void test_level_positions_should_name_the_same_scene_point_when_a_ramp_is_halved() {
  const TestImage ramp(64, 64, [](int x, int y) { return 2 * x + y; });
  const Built built(ramp, 3);
  for (int l = 1; l < 3; ++l) {
    const Vec2 at_level(5, 6);
    const Vec2 at_zero = from_level(at_level, l);
    const double expected = 2 * static_cast<double>(at_zero.x()) + static_cast<double>(at_zero.y());
    TEST_ASSERT_DOUBLE_WITHIN(1.0, expected, built.pyramid.level[l].at(5, 6));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 5, static_cast<double>(to_level(at_zero, l).x()));
  }
}

void test_upright_template_should_be_the_image_when_nothing_is_warped() {
  SeededRandom random(12);
  const TestImage image = noise_image(64, 64, &random);
  const Built built(image, 2);
  SourcePatch patch;
  for (const int at : {7, 20, 56}) {
    TEST_ASSERT_TRUE(extract_source(built.pyramid, Vec2(at, at), &patch));
    float out[kWarpSize * kWarpSize];
    TEST_ASSERT_TRUE(warp_template(patch, Mat2::Identity(), kWarpSize, out));
    for (int j = 0; j < kWarpSize; ++j) {
      for (int i = 0; i < kWarpSize; ++i) {
        const int grey = image.view().at(at + i - kWarpSize / 2, at + j - kWarpSize / 2);
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, static_cast<float>(grey), out[j * kWarpSize + i]);
      }
    }
  }
}

void test_warped_template_should_follow_the_texture_when_turned_and_zoomed() {
  SeededRandom random(13);
  const Texture texture(&random, 16, 40);
  const TestImage image(96, 96, [&](int x, int y) { return texture.at(x, y); });
  const Built built(image, 2);
  const Vec2 centre(Scalar(47.3), Scalar(46.8));
  SourcePatch patch;
  TEST_ASSERT_TRUE(extract_source(built.pyramid, centre, &patch));
  for (const double scale : {0.5, 1.0, 1.5, 2.0, 3.0}) {
    Mat2 A;
    A << Scalar(0.9 * scale), Scalar(-0.3 * scale), Scalar(0.4 * scale), Scalar(0.8 * scale);
    float out[kAlignSize * kAlignSize];
    TEST_ASSERT_TRUE(warp_template(patch, A, kAlignSize, out));
    double square = 0;
    for (int j = 0; j < kAlignSize; ++j) {
      for (int i = 0; i < kAlignSize; ++i) {
        const Vec2 offset(static_cast<Scalar>(i - kAlignSize / 2), static_cast<Scalar>(j - kAlignSize / 2));
        const Vec2 at = centre + A.lazyProduct(offset);
        const double error = static_cast<double>(out[j * kAlignSize + i]) -
                             texture.at(static_cast<double>(at.x()), static_cast<double>(at.y()));
        square += error * error;
      }
    }
    EXPECT_BELOW(3.0, std::sqrt(square / (kAlignSize * kAlignSize)));
  }
}

void test_patch_should_be_refused_when_the_edge_is_too_near_or_the_pixel_is_no_number() {
  const TestImage image(32, 32);
  const Built built(image, 1);
  SourcePatch patch;
  const Scalar nan = std::numeric_limits<Scalar>::quiet_NaN();
  for (const Scalar at : {Scalar(6.9), Scalar(24.1), Scalar(-3), Scalar(1e9), nan}) {
    TEST_ASSERT_FALSE(extract_source(built.pyramid, Vec2(at, 16), &patch));
    TEST_ASSERT_FALSE(extract_source(built.pyramid, Vec2(16, at), &patch));
  }
  TEST_ASSERT_TRUE(extract_source(built.pyramid, Vec2(7, 24), &patch));
  float out[kWarpSize * kWarpSize];
  TEST_ASSERT_FALSE(warp_template(patch, Mat2::Identity() * Scalar(1.3), kWarpSize, out));
  TEST_ASSERT_FALSE(warp_template(patch, Mat2::Identity() * Scalar(2), kWarpSize, out));  // no level 1 here
  TEST_ASSERT_FALSE(warp_template(patch, Mat2::Identity() * nan, kWarpSize, out));
}

void test_warp_should_stay_inside_its_patch_when_any_matrix_is_tried() {
  SeededRandom random(14);
  const TestImage image = noise_image(64, 48, &random);
  const Built built(image, 2);
  int taken = 0;
  for (int k = 0; k < 3000; ++k) {
    SourcePatch patch;
    const Vec2 pixel(static_cast<Scalar>(random.uniform(0, 64)), static_cast<Scalar>(random.uniform(0, 48)));
    if (!extract_source(built.pyramid, pixel, &patch)) continue;
    Mat2 A;
    for (int i = 0; i < 4; ++i) A(i / 2, i % 2) = static_cast<Scalar>(random.uniform(-3, 3));
    float out[15 * 15];
    taken += warp_template(patch, A, 15, out) ? 1 : 0;
  }
  TEST_ASSERT_GREATER_THAN_INT(30, taken);
}

void test_statistics_should_be_those_of_the_definition_when_the_image_is_noise() {
  SeededRandom random(15);
  const TestImage image = noise_image(53, 31, &random);
  double sum = 0, square = 0, gradient = 0;
  for (int y = 0; y < 31; ++y) {
    for (int x = 0; x < 53; ++x) {
      const double grey = image.view().at(x, y);
      sum += grey;
      square += grey * grey;
      if (x < 52 && y < 30) {
        gradient += std::pow(image.view().at(x + 1, y) - grey, 2) + std::pow(image.view().at(x, y + 1) - grey, 2);
      }
    }
  }
  const double n = 53 * 31;
  const FrameStatistics s = frame_statistics(image.view());
  TEST_ASSERT_DOUBLE_WITHIN(1e-3, sum / n, static_cast<double>(s.mean));
  TEST_ASSERT_DOUBLE_WITHIN(1e-3, std::sqrt(square / n - sum * sum / n / n), static_cast<double>(s.deviation));
  TEST_ASSERT_DOUBLE_WITHIN(0.5, gradient / (52 * 30), static_cast<double>(s.gradient_energy));
  TEST_ASSERT_EQUAL_INT(static_cast<int>(FrameUse::kUsable), static_cast<int>(judge_frame(s)));
}

void test_frame_should_be_named_unusable_when_it_is_black_white_or_grey() {
  SeededRandom random(16);
  const auto judge = [&](double grey) {
    const TestImage image(80, 60, [&](int, int) { return grey + random.normal(); });
    return static_cast<int>(judge_frame(frame_statistics(image.view())));
  };
  TEST_ASSERT_EQUAL_INT(static_cast<int>(FrameUse::kDark), judge(1));
  TEST_ASSERT_EQUAL_INT(static_cast<int>(FrameUse::kBright), judge(255));
  TEST_ASSERT_EQUAL_INT(static_cast<int>(FrameUse::kFlat), judge(120));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_halving_should_equal_its_plain_twin_when_sides_are_odd_or_small);
  RUN_TEST(test_levels_should_be_as_many_as_sides_allow_when_more_are_asked_for);
  RUN_TEST(test_layout_should_take_the_same_bytes_when_it_only_counts);
  RUN_TEST(test_level_positions_should_name_the_same_scene_point_when_a_ramp_is_halved);
  RUN_TEST(test_upright_template_should_be_the_image_when_nothing_is_warped);
  RUN_TEST(test_warped_template_should_follow_the_texture_when_turned_and_zoomed);
  RUN_TEST(test_patch_should_be_refused_when_the_edge_is_too_near_or_the_pixel_is_no_number);
  RUN_TEST(test_warp_should_stay_inside_its_patch_when_any_matrix_is_tried);
  RUN_TEST(test_statistics_should_be_those_of_the_definition_when_the_image_is_noise);
  RUN_TEST(test_frame_should_be_named_unusable_when_it_is_black_white_or_grey);
  return UNITY_END();
}
