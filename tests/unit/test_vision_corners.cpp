// Corners: the tuned segment test and score against their plain twins, the rectangle's bounds, order and capacity.
#include "support/textured_images.h"
#include "unity.h"
#include "vision/corners.h"
#include "vision/segment_test.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

std::vector<Corner> detect(const TestImage& image, const Rect& roi, int threshold, int capacity) {
  TestArena arena;
  CornerWorkspace workspace;
  TEST_ASSERT_TRUE(workspace.layout(*arena, image.view().width));
  std::vector<Corner> out(static_cast<std::size_t>(capacity));
  const int count = detect_corners(image.view(), roi, threshold, out.data(), capacity, workspace);
  TEST_ASSERT_LESS_OR_EQUAL_INT(capacity, count);
  out.resize(static_cast<std::size_t>(count));
  return out;
}

/// Blurred steps, so that corners exist at every contrast.
TestImage squares(SeededRandom* random) {
  TestImage image(120, 90, [&](int, int) { return 100 + random->normal(); });
  for (int k = 0; k < 25; ++k) {
    const int x0 = static_cast<int>(random->uniform(0, 110));
    const int y0 = static_cast<int>(random->uniform(0, 80));
    const double grey = random->uniform(0, 255);
    for (int y = y0; y < y0 + 9 && y < 90; ++y) {
      for (int x = x0; x < x0 + 9 && x < 120; ++x) image.set(x, y, grey + random->normal());
    }
  }
  return image;
}

void test_segment_test_should_equal_its_plain_twin_when_any_threshold_is_used() {
  SeededRandom random(21);
  for (int kind = 0; kind < 2; ++kind) {
    const TestImage image = kind == 0 ? squares(&random) : noise_image(120, 90, &random);
    int all = 0;
    for (const int threshold : {1, 10, 40, 100, 200, 254}) {
      for (int y = 3; y < 87; ++y) {
        std::uint16_t fast[120], plain[120];
        const int x0 = 3 + y % 20;
        const int count = 1 + (y * 7) % (117 - x0);
        const int a = segment_test_row(image.view().pixel(x0, y), 120, count, threshold, fast);
        const int b = segment_test_row_reference(image.view().pixel(x0, y), 120, count, threshold, plain);
        TEST_ASSERT_EQUAL_INT(b, a);
        if (b > 0) TEST_ASSERT_EQUAL_UINT16_ARRAY(plain, fast, static_cast<unsigned>(b));
        all += a;
      }
    }
    TEST_ASSERT_GREATER_THAN_INT(50, all);
  }
}

void test_segment_test_should_ask_for_nine_in_a_row_when_the_circle_is_drawn_by_hand() {
  const int cx[16] = {0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1};
  const int cy[16] = {-3, -3, -2, -1, 0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3};
  for (const int sign : {-1, 1}) {
    for (int length = 7; length <= 16; ++length) {
      for (int first = 0; first < 16; ++first) {
        TestImage image(7, 7, [](int, int) { return 100; });
        for (int k = 0; k < length; ++k) image.set(3 + cx[(first + k) % 16], 3 + cy[(first + k) % 16], 100 + 21 * sign);
        TEST_ASSERT_EQUAL_INT(length >= 9, is_segment_corner(image.view(), 3, 3, 20));
        TEST_ASSERT_FALSE(is_segment_corner(image.view(), 3, 3, 21));
      }
    }
  }
}

void test_score_should_equal_its_plain_twin_when_taken_everywhere() {
  SeededRandom random(22);
  const TestImage image = noise_image(32, 32, &random);
  for (int y = -2; y < 34; ++y) {
    for (int x = -2; x < 34; ++x) {
      const float fast = min_eigenvalue(image.view(), x, y);
      TEST_ASSERT_EQUAL_FLOAT(min_eigenvalue_reference(image.view(), x, y), fast);
      TEST_ASSERT_EQUAL_INT(image.view().contains(x, y, kCornerBorder), fast > 0);
    }
  }
}

void test_score_should_be_zero_when_there_is_only_one_direction() {
  const TestImage edge(32, 32, [](int x, int y) { return x + y > 32 ? 200 : 20; });
  TEST_ASSERT_FLOAT_WITHIN(1e-2f, 0, min_eigenvalue(edge.view(), 16, 16));
}

void test_corners_should_sit_on_the_squares_when_a_checker_with_grey_joints_is_seen() {
  // A single bright square on dark ground: its four corners and nothing else.
  const TestImage image(64, 64, [](int x, int y) { return x >= 20 && x < 40 && y >= 22 && y < 44 ? 220 : 30; });
  const std::vector<Corner> found = detect(image, Rect{0, 0, 64, 64}, 20, 20);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(4, static_cast<int>(found.size()));
  for (const int corner_x : {20, 39}) {
    for (const int corner_y : {22, 43}) {
      int near = 0;
      for (const Corner& c : found)
        near +=
            std::fabs(c.x - static_cast<float>(corner_x)) <= 2 && std::fabs(c.y - static_cast<float>(corner_y)) <= 2;
      TEST_ASSERT_EQUAL_INT(1, near);
    }
  }
  TEST_ASSERT_EQUAL_INT(4, static_cast<int>(found.size()));
}

void test_corners_should_be_peaks_in_order_when_the_image_is_busy() {
  SeededRandom random(23);
  const TestImage image = squares(&random);
  const std::vector<Corner> all = detect(image, Rect{0, 0, 120, 90}, 15, 1000);
  TEST_ASSERT_GREATER_THAN_INT(20, static_cast<int>(all.size()));
  for (std::size_t k = 0; k < all.size(); ++k) {
    const int x = static_cast<int>(all[k].x);
    const int y = static_cast<int>(all[k].y);
    TEST_ASSERT_TRUE(image.view().contains(x, y, kCornerBorder));
    TEST_ASSERT_TRUE(is_segment_corner(image.view(), x, y, 15));
    TEST_ASSERT_EQUAL_FLOAT(min_eigenvalue(image.view(), x, y), all[k].score);
    if (k > 0) TEST_ASSERT_TRUE(all[k - 1].score >= all[k].score);
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        if (!image.view().contains(x + i, y + j, kCornerBorder)) continue;
        if (!is_segment_corner(image.view(), x + i, y + j, 15)) continue;
        TEST_ASSERT_TRUE(min_eigenvalue(image.view(), x + i, y + j) <= all[k].score);
      }
    }
  }
  const std::vector<Corner> few = detect(image, Rect{0, 0, 120, 90}, 15, 7);
  TEST_ASSERT_EQUAL_INT(7, static_cast<int>(few.size()));
  for (std::size_t k = 0; k < few.size(); ++k) TEST_ASSERT_EQUAL_FLOAT(all[k].score, few[k].score);
}

void test_corners_should_stay_in_the_rectangle_when_it_lies_anywhere() {
  SeededRandom random(24);
  const TestImage image = noise_image(32, 32, &random);
  const Rect rects[] = {{0, 0, 32, 32},
                        {-100, -100, 1000, 1000},
                        {30, 30, 5, 5},
                        {5, 5, 1, 1},
                        {10, 8, 3, 17},
                        {26, 26, 1, 1},
                        {12, 12, 0, 5},
                        {12, 12, -4, 5},
                        {40, 3, 9, 9},
                        {-9, 3, 12, 9},
                        {2000000000, 0, 2000000000, 32},
                        {0, -2000000000, 32, 5}};
  for (const Rect& r : rects) {
    for (const Corner& c : detect(image, r, 5, 100)) {
      TEST_ASSERT_TRUE(c.x >= static_cast<float>(r.x) && static_cast<double>(c.x) < double(r.x) + r.width);
      TEST_ASSERT_TRUE(c.y >= static_cast<float>(r.y) && static_cast<double>(c.y) < double(r.y) + r.height);
      TEST_ASSERT_TRUE(image.view().contains(static_cast<int>(c.x), static_cast<int>(c.y), kCornerBorder));
    }
  }
  TEST_ASSERT_EQUAL_INT(0, static_cast<int>(detect(image, Rect{0, 0, 32, 32}, 5, 0).size()));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_segment_test_should_equal_its_plain_twin_when_any_threshold_is_used);
  RUN_TEST(test_segment_test_should_ask_for_nine_in_a_row_when_the_circle_is_drawn_by_hand);
  RUN_TEST(test_score_should_equal_its_plain_twin_when_taken_everywhere);
  RUN_TEST(test_score_should_be_zero_when_there_is_only_one_direction);
  RUN_TEST(test_corners_should_sit_on_the_squares_when_a_checker_with_grey_joints_is_seen);
  RUN_TEST(test_corners_should_be_peaks_in_order_when_the_image_is_busy);
  RUN_TEST(test_corners_should_stay_in_the_rectangle_when_it_lies_anywhere);
  return UNITY_END();
}
