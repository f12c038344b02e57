// Laws of a plane's outline: it is convex, lies in the hull of its points, and hardly loses area when it is simplified.
#include <cmath>
#include <vector>

#include "map/plane_outline.h"
#include "same.h"
#include "support/seeded_random.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr bool kFloat = sizeof(Scalar) == 4;
constexpr Scalar kTiny = kFloat ? Scalar(1e-5) : Scalar(1e-12);

std::vector<Vec2> points_in_disc(SeededRandom& random, int count) {
  std::vector<Vec2> points;
  for (int i = 0; i < count; ++i) {
    const double angle = random.uniform(0, 6.283185307179586), r = std::sqrt(random.uniform(0, 1));
    points.emplace_back(static_cast<Scalar>(r * std::cos(angle)), static_cast<Scalar>(r * std::sin(angle)));
  }
  return points;
}

PlaneOutline outline_of(const std::vector<Vec2>& points) {
  PlaneOutline outline;
  extend_outline(&outline, points.data(), static_cast<int>(points.size()));
  return outline;
}

void assert_convex(const PlaneOutline& outline) {
  for (int i = 0; i < outline.count; ++i) {
    const Vec2 &a = outline.uv[i], &b = outline.uv[(i + 1) % outline.count], &c = outline.uv[(i + 2) % outline.count];
    TEST_ASSERT_TRUE(twice_area(a, b, c) > -kTiny);
  }
}

void test_outline_should_hold_every_point_when_there_are_few() {
  SeededRandom random(51);
  for (int trial = 0; trial < 100; ++trial) {
    const std::vector<Vec2> points = points_in_disc(random, 3 + trial % 20);
    const PlaneOutline outline = outline_of(points);
    assert_convex(outline);
    TEST_ASSERT_TRUE(outline_area(outline) > 0);
    for (const Vec2& p : points) TEST_ASSERT_TRUE(outline_contains(outline, p, kTiny));
    for (int i = 0; i < outline.count; ++i) {
      bool is_a_point = false;
      for (const Vec2& p : points) is_a_point = is_a_point || p == outline.uv[i];
      TEST_ASSERT_TRUE(is_a_point);
    }
  }
}

void test_outline_should_not_depend_on_the_order_when_nothing_is_simplified() {
  SeededRandom random(52);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Vec2> points = points_in_disc(random, 20);
    const PlaneOutline all = outline_of(points);
    PlaneOutline one_by_one;
    for (std::size_t i = points.size(); i > 0; --i) extend_outline(&one_by_one, &points[i - 1], 1);
    TEST_ASSERT_EQUAL_INT(all.count, one_by_one.count);
    for (int i = 0; i < all.count; ++i) TEST_ASSERT_SAME(one_by_one.uv[i], all.uv[i]);
  }
}

void test_outline_should_stay_inside_the_hull_when_vertices_are_dropped() {
  SeededRandom random(53);
  // 400 points on a circle: each is a vertex of their hull, whose area is all but that of the disc.
  std::vector<Vec2> points;
  for (int i = 0; i < 400; ++i) {
    const double angle = random.uniform(0, 6.283185307179586);
    points.emplace_back(static_cast<Scalar>(2 * std::cos(angle)), static_cast<Scalar>(2 * std::sin(angle)));
  }
  const PlaneOutline outline = outline_of(points);
  TEST_ASSERT_EQUAL_INT(kMaxOutline, outline.count);
  assert_convex(outline);
  const double disc = 4 * 3.14159265358979, share = static_cast<double>(outline_area(outline)) / disc;
  // A regular polygon of 24 vertices has 0.9886 of its circle's area, and none has more.
  std::printf("%d of 400 vertices kept, %.4f of the area\n", outline.count, share);
  TEST_ASSERT_TRUE(share > 0.95 && share < 0.9887);
}

void test_outline_should_never_shrink_by_much_when_points_come_for_ever() {
  SeededRandom random(54);
  PlaneOutline outline;
  Scalar largest = 0;
  for (int round = 0; round < 200; ++round) {
    const std::vector<Vec2> points = points_in_disc(random, 10);
    extend_outline(&outline, points.data(), 10);
    const Scalar area = outline_area(outline);
    TEST_ASSERT_TRUE(outline.count <= kMaxOutline && area > Scalar(0.97) * largest && area < Scalar(3.1416));
    largest = std::max(largest, area);
  }
  TEST_ASSERT_TRUE(largest > Scalar(2.8));
}

void test_outline_should_have_no_area_when_points_are_in_line_or_the_same() {
  std::vector<Vec2> line;
  for (int i = 0; i < 70; ++i)
    line.emplace_back(static_cast<Scalar>((i * 13) % 70), static_cast<Scalar>((i * 26) % 140));
  PlaneOutline outline = outline_of(line);
  TEST_ASSERT_SAME(0, outline_area(outline));
  TEST_ASSERT_FALSE(outline_contains(outline, Vec2(1, 2)));
  outline = outline_of(std::vector<Vec2>(90, Vec2(3, 4)));
  TEST_ASSERT_TRUE(outline.count <= 2);
  TEST_ASSERT_SAME(0, outline_area(outline));
  outline = outline_of({Vec2(0, 0), Vec2(1, 0)});
  TEST_ASSERT_EQUAL_INT(2, outline.count);
  outline = outline_of({});
  TEST_ASSERT_EQUAL_INT(0, outline.count);
}

void test_outline_should_leave_points_out_when_they_are_not_finite() {
  const Scalar nan = std::sqrt(Scalar(-1));
  const PlaneOutline outline = outline_of({Vec2(0, 0), Vec2(nan, 1), Vec2(1, 0), Vec2(1, 1 / Scalar(0)), Vec2(0, 1)});
  TEST_ASSERT_EQUAL_INT(3, outline.count);
  TEST_ASSERT_TRUE(std::abs(outline_area(outline) - Scalar(0.5)) < kTiny);
}

void test_isolated_point_should_be_rejected_when_it_lies_far_from_all_others() {
  SeededRandom random(55);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Vec2> points = points_in_disc(random, 8 + trial);
    const int place = trial % static_cast<int>(points.size());
    points.insert(points.begin() + place, Vec2(6, 1));
    const std::vector<Vec2> before = points;
    const int count = static_cast<int>(points.size()), kept = reject_isolated(points.data(), count);
    TEST_ASSERT_TRUE(kept < count && kept >= 3 * count / 4);
    for (int i = 0, k = 0; i < count && k < kept; ++i) {
      const std::size_t from = static_cast<std::size_t>(i), to = static_cast<std::size_t>(k);
      if (before[from] == points[to]) ++k;
      if (i + 1 == count) TEST_ASSERT_EQUAL_INT(kept, k);  // in their order
    }
    for (int k = 0; k < kept; ++k) TEST_ASSERT_TRUE(points[static_cast<std::size_t>(k)].x() < 5);
  }
}

void test_no_point_should_be_rejected_when_they_are_few_or_evenly_spread() {
  std::vector<Vec2> grid;
  for (int i = 0; i < 30; ++i) grid.emplace_back(static_cast<Scalar>(i % 6), static_cast<Scalar>(i / 6));
  TEST_ASSERT_EQUAL_INT(30, reject_isolated(grid.data(), 30));
  std::vector<Vec2> few = {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1), Vec2(1, 1), Vec2(90, 0)};
  TEST_ASSERT_EQUAL_INT(5, reject_isolated(few.data(), 5));
  std::vector<Vec2> same(20, Vec2(1, 1));
  TEST_ASSERT_EQUAL_INT(20, reject_isolated(same.data(), 20));
  TEST_ASSERT_EQUAL_INT(0, reject_isolated(few.data(), 0));
}

void test_contains_should_widen_by_the_margin_when_there_is_one() {
  const PlaneOutline square = outline_of({Vec2(0, 0), Vec2(2, 0), Vec2(2, 2), Vec2(0, 2), Vec2(1, 1)});
  TEST_ASSERT_EQUAL_INT(4, square.count);
  TEST_ASSERT_TRUE(std::abs(outline_area(square) - 4) < kTiny);
  TEST_ASSERT_TRUE(outline_contains(square, Vec2(1, 1)));
  TEST_ASSERT_TRUE(outline_contains(square, Vec2(2, 1)));
  TEST_ASSERT_FALSE(outline_contains(square, Vec2(Scalar(2.1), 1)));
  TEST_ASSERT_TRUE(outline_contains(square, Vec2(Scalar(2.1), 1), Scalar(0.11)));
  TEST_ASSERT_FALSE(outline_contains(square, Vec2(Scalar(2.1), 1), Scalar(0.09)));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_outline_should_hold_every_point_when_there_are_few);
  RUN_TEST(test_outline_should_not_depend_on_the_order_when_nothing_is_simplified);
  RUN_TEST(test_outline_should_stay_inside_the_hull_when_vertices_are_dropped);
  RUN_TEST(test_outline_should_never_shrink_by_much_when_points_come_for_ever);
  RUN_TEST(test_outline_should_have_no_area_when_points_are_in_line_or_the_same);
  RUN_TEST(test_outline_should_leave_points_out_when_they_are_not_finite);
  RUN_TEST(test_isolated_point_should_be_rejected_when_it_lies_far_from_all_others);
  RUN_TEST(test_no_point_should_be_rejected_when_they_are_few_or_evenly_spread);
  RUN_TEST(test_contains_should_widen_by_the_margin_when_there_is_one);
  return UNITY_END();
}
