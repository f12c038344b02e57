// Search inside an ellipse: tuned against plain, the known place, the second peak, bounds.
#include <limits>

#include "support/bounds.h"
#include "support/textured_images.h"
#include "unity.h"
#include "vision/search.h"
#include "vision/search_kernels.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

SearchTemplate template_at(const ImageView& image, int x, int y) {
  constexpr int kSide = 9;
  float window[kSide * kSide];
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) window[j * kSide + i] = static_cast<float>(image.at(x - 4 + i, y - 4 + j));
  }
  SearchTemplate out;
  make_search_template(window, kSide, &out);
  return out;
}

SearchEllipse circle(double x, double y, double radius) {
  SearchEllipse out;
  out.centre = Vec2(static_cast<Scalar>(x), static_cast<Scalar>(y));
  out.gate = static_cast<Scalar>(radius * radius);
  return out;
}

/// The definition of search, pixel by pixel.
SearchResult search_reference(const ImageView& image, const SearchTemplate& pattern, const SearchEllipse& ellipse) {
  const auto inside = [&](int x, int y) {
    if (x < 4 || y < 4 || x > image.width - 4 || y > image.height - 4) return false;
    const double dx = x - static_cast<double>(ellipse.centre.x());
    const double dy = y - static_cast<double>(ellipse.centre.y());
    if (std::abs(x - std::floor(static_cast<double>(ellipse.centre.x()) + 0.5)) > kSearchReach) return false;
    if (std::abs(y - std::floor(static_cast<double>(ellipse.centre.y()) + 0.5)) > kSearchReach) return false;
    const double a = static_cast<double>(ellipse.inverse_covariance(0, 0));
    const double b = static_cast<double>(ellipse.inverse_covariance(0, 1));
    const double c = static_cast<double>(ellipse.inverse_covariance(1, 1));
    return a * dx * dx + 2 * b * dx * dy + c * dy * dy <= static_cast<double>(ellipse.gate);
  };
  SearchResult out;
  out.score = -2;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (!inside(x, y)) continue;
      ++out.visited;
      const float score = correlation_reference(image, pattern, x, y);
      if (score <= out.score) continue;
      out.score = score;
      out.position = Vec2(x, y);
    }
  }
  const auto quantised = [&](int x, int y) {
    return inside(x, y) ? static_cast<int>(correlation_reference(image, pattern, x, y) * 32000.0f) : -40000;
  };
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (!inside(x, y)) continue;
      const double distance =
          std::hypot(x - static_cast<double>(out.position.x()), y - static_cast<double>(out.position.y()));
      if (distance <= static_cast<double>(kSearchApart)) continue;
      bool peak = true;
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) peak = peak && quantised(x + i, y + j) <= quantised(x, y);
      }
      const float second = static_cast<float>(quantised(x, y)) / 32000.0f;
      if (peak && second > out.second) out.second = second;
    }
  }
  return out;
}

void expect_same(const SearchResult& expected, const SearchResult& actual) {
  TEST_ASSERT_EQUAL_INT(expected.visited, actual.visited);
  if (expected.visited == 0) return;
  TEST_ASSERT_EQUAL_INT(static_cast<int>(expected.position.x()), static_cast<int>(actual.position.x()));
  TEST_ASSERT_EQUAL_INT(static_cast<int>(expected.position.y()), static_cast<int>(actual.position.y()));
  TEST_ASSERT_EQUAL_FLOAT(expected.score, actual.score);
  TEST_ASSERT_EQUAL_FLOAT(expected.second, actual.second);
}

void test_dots_should_equal_their_plain_twin_when_any_count_is_asked() {
  SeededRandom random(31);
  const TestImage image = noise_image(90, 8, &random);
  const SearchTemplate pattern = template_at(noise_image(9, 9, &random).view(), 4, 4);
  for (int count = 1; count <= 83; ++count) {
    std::vector<std::uint32_t> fast(static_cast<std::size_t>(count)), plain(fast);
    window_dots(image.view().pixel(83 - count, 0), 90, count, pattern, fast.data());
    window_dots_reference(image.view().pixel(83 - count, 0), 90, count, pattern, plain.data());
    TEST_ASSERT_EQUAL_MEMORY(plain.data(), fast.data(), plain.size() * sizeof plain[0]);
  }
}

void test_search_should_equal_the_definition_when_ellipses_and_places_are_random() {
  SeededRandom random(32);
  const Texture texture(&random, 6, 30);
  const TestImage smooth(100, 80, [&](int x, int y) { return texture.at(x, y) + 3 * random.normal(); });
  const TestImage noise = noise_image(100, 80, &random);
  const TestImage extreme(100, 80, [&](int, int) { return random.uniform(0, 1) < 0.5 ? 0 : 255; });
  for (const TestImage* image : {&smooth, &noise, &extreme}) {
    for (int k = 0; k < 60; ++k) {
      const int x = static_cast<int>(random.uniform(4, 95));
      const int y = static_cast<int>(random.uniform(4, 75));
      const SearchTemplate pattern = template_at(image->view(), x, y);
      SearchEllipse ellipse = circle(x + random.uniform(-8, 8), y + random.uniform(-8, 8), 1);
      const double turn = random.uniform(0, 3.14), long_side = random.uniform(1, 45), share = random.uniform(0.05, 1);
      const double c = std::cos(turn), s = std::sin(turn);
      const double p = 1 / (long_side * long_side), q = p / (share * share);
      ellipse.inverse_covariance << static_cast<Scalar>(c * c * p + s * s * q), static_cast<Scalar>(c * s * (p - q)),
          static_cast<Scalar>(c * s * (p - q)), static_cast<Scalar>(s * s * p + c * c * q);
      const SearchResult expected = search_reference(image->view(), pattern, ellipse);
      const SearchResult actual = search(image->view(), pattern, ellipse);
      if (expected.visited > 0) expect_same(expected, actual);
    }
  }
}

void test_search_should_find_the_known_place_when_gain_bias_and_noise_change() {
  SeededRandom random(33);
  const Texture texture(&random, 8, 30);
  const TestImage before(90, 90, [&](int x, int y) { return texture.at(x, y); });
  const TestImage after(90, 90, [&](int x, int y) { return 0.6 * texture.at(x - 7, y + 5) + 30 + random.normal(); });
  for (int y = 20; y < 70; y += 7) {
    for (int x = 20; x < 70; x += 7) {
      const SearchResult found = search(after.view(), template_at(before.view(), x, y), circle(x, y, 12));
      TEST_ASSERT_EQUAL_INT(x + 7, static_cast<int>(found.position.x()));
      TEST_ASSERT_EQUAL_INT(y - 5, static_cast<int>(found.position.y()));
      EXPECT_NOT_BELOW(0.97f, found.score);
      EXPECT_BELOW(found.score, found.second);
    }
  }
}

void test_second_should_be_as_good_as_the_best_when_the_texture_repeats() {
  const TestImage stripes(
      80, 80, [](int x, int y) { return 128 + 50 * std::sin(x * 0.7853981) + 50 * std::sin(y * 0.7853981); });
  const SearchResult found = search(stripes.view(), template_at(stripes.view(), 40, 40), circle(40, 40, 10));
  EXPECT_NOT_BELOW(0.999f, found.score);
  EXPECT_NOT_BELOW(0.99f, found.second);
  const TestImage blob(
      80, 80, [](int x, int y) { return 40 + 200 * std::exp(-0.02 * (std::pow(x - 40, 2) + std::pow(y - 40, 2))); });
  const SearchResult single = search(blob.view(), template_at(blob.view(), 40, 40), circle(40, 40, 4));
  TEST_ASSERT_EQUAL_INT(40, static_cast<int>(single.position.x()));
  EXPECT_BELOW(0.0f, single.second);  // the shoulder of the peak is no second one
}

void test_search_should_visit_its_own_pixel_when_the_ellipse_is_smaller_than_one() {
  SeededRandom random(34);
  const TestImage image = noise_image(32, 32, &random);
  const SearchResult found = search(image.view(), template_at(image.view(), 12, 13), circle(12.4, 13.4, 0.1));
  TEST_ASSERT_EQUAL_INT(1, found.visited);
  TEST_ASSERT_EQUAL_INT(12, static_cast<int>(found.position.x()));
  EXPECT_NOT_BELOW(0.999f, found.score);
  EXPECT_BELOW(0.0f, found.second);
}

void test_search_should_stay_in_the_image_when_the_centre_is_anywhere() {
  SeededRandom random(35);
  for (int side = 32; side < 45; side += 3) {
    const TestImage image = noise_image(side, side, &random);
    const SearchTemplate pattern = template_at(image.view(), 10, 10);
    for (int y = -40; y < side + 40; y += 3) {
      for (int x = -40; x < side + 40; x += 3) {
        const SearchEllipse ellipse = circle(x, y, (x + y + 80) % 13 + 1);
        const SearchResult found = search(image.view(), pattern, ellipse);
        expect_same(search_reference(image.view(), pattern, ellipse), found);
      }
    }
  }
}

void test_nothing_should_be_visited_when_the_ellipse_or_the_template_is_no_good() {
  SeededRandom random(36);
  const TestImage image = noise_image(40, 40, &random);
  const SearchTemplate good = template_at(image.view(), 20, 20);
  const TestImage flat(40, 40, [](int, int) { return 90; });
  const SearchTemplate blank = template_at(flat.view(), 20, 20);
  TEST_ASSERT_EQUAL_INT(0, search(image.view(), blank, circle(20, 20, 3)).visited);
  const SearchResult on_flat = search(flat.view(), good, circle(20, 20, 3));
  TEST_ASSERT_EQUAL_FLOAT(0, on_flat.score);
  const Scalar nan = std::numeric_limits<Scalar>::quiet_NaN();
  const Scalar infinity = std::numeric_limits<Scalar>::infinity();
  for (const Scalar bad : {nan, infinity, -infinity, Scalar(-1)}) {
    SearchEllipse e = circle(20, 20, 3);
    e.gate = bad;
    TEST_ASSERT_EQUAL_INT(0, search(image.view(), good, e).visited);
    e = circle(20, 20, 3);
    e.inverse_covariance(1, 1) = bad;
    TEST_ASSERT_EQUAL_INT(0, search(image.view(), good, e).visited);
    e = circle(20, 20, 3);
    e.inverse_covariance(0, 1) = e.inverse_covariance(1, 0) = bad;
    TEST_ASSERT_EQUAL_INT(0, search(image.view(), good, e).visited);
    e = circle(20, 20, 3);
    e.centre.x() = bad;
    if (bad != Scalar(-1)) TEST_ASSERT_EQUAL_INT(0, search(image.view(), good, e).visited);
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_dots_should_equal_their_plain_twin_when_any_count_is_asked);
  RUN_TEST(test_search_should_equal_the_definition_when_ellipses_and_places_are_random);
  RUN_TEST(test_search_should_find_the_known_place_when_gain_bias_and_noise_change);
  RUN_TEST(test_second_should_be_as_good_as_the_best_when_the_texture_repeats);
  RUN_TEST(test_search_should_visit_its_own_pixel_when_the_ellipse_is_smaller_than_one);
  RUN_TEST(test_search_should_stay_in_the_image_when_the_centre_is_anywhere);
  RUN_TEST(test_nothing_should_be_visited_when_the_ellipse_or_the_template_is_no_good);
  return UNITY_END();
}
