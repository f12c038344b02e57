// One search: what is a plane, what is none, and what stays untouched.
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "base/false_alarms.h"
#include "map/plane_search.h"
#include "same.h"
#include "support/seeded_random.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

const Vec3 kViewer(0, 0, 3);

PlaneCandidate candidate(const Vec3& p_W) { return {p_W, Mat3::Identity() * Scalar(4e-6), 0}; }

Vec3 at(double x, double y, double z) {
  return Vec3(static_cast<Scalar>(x), static_cast<Scalar>(y), static_cast<Scalar>(z));
}

/// Coordinates in the order in which they are drawn: left to right in braces; among arguments the compiler chooses.
struct Drawn {
  double z, y, x;
};

Vec3 drawn(const Drawn& p) { return at(p.x, p.y, p.z); }

/// Points of the plane z = 0 within 0.8 m of the origin, 2 mm rough.
void add_wall(SeededRandom& random, int count, std::vector<PlaneCandidate>* points) {
  for (int i = 0; i < count; ++i) {
    points->push_back(
        candidate(drawn({0.002 * random.normal(), random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6)})));
  }
}

struct Found {
  bool any = false;
  PlaneFit fit;
  int members[kMaxPlaneMembers], count = 0;

  /// Their names are their indices.
  Found(std::vector<PlaneCandidate> points, const PlaneSearchSettings& settings, std::uint32_t search = 7) {
    for (std::size_t i = 0; i < points.size(); ++i) points[i].name = static_cast<int>(i);
    any =
        search_plane(points.data(), static_cast<int>(points.size()), settings, kViewer, search, &fit, members, &count);
  }
};

void test_search_should_find_the_wall_when_clutter_stands_before_it() {
  SeededRandom random(61);
  int all = 0, walls = 0;
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<PlaneCandidate> points;
    add_wall(random, 14, &points);
    for (int i = 0; i < 30; ++i) {
      points.push_back(candidate(drawn({random.uniform(0.1, 1.5), random.uniform(-1, 1), random.uniform(-1, 1)})));
    }
    const Found found(points, PlaneSearchSettings{});
    if (!found.any) continue;
    ++walls;
    for (int k = 0; k < found.count; ++k) {
      TEST_ASSERT_TRUE(found.members[k] < 14);
      for (int i = 0; i < k; ++i) TEST_ASSERT_TRUE(found.members[i] != found.members[k]);
    }
    all += found.count;
    TEST_ASSERT_EQUAL_INT(found.count, found.fit.count);
    TEST_ASSERT_TRUE(found.fit.frame.R_WP(2, 2) > Scalar(0.999));  // towards the viewer
    TEST_ASSERT_TRUE(std::abs(found.fit.frame.o_W.z()) < Scalar(0.003));
  }
  std::printf("%d of 40 walls, %.2f of 14 points are members\n", walls, all / static_cast<double>(walls));
  TEST_ASSERT_TRUE(walls >= 38 && all >= 13 * walls);
}

void test_search_should_find_nothing_when_there_is_only_clutter() {
  SeededRandom random(62);
  int found = 0;
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<PlaneCandidate> points;
    for (int i = 0; i < 100; ++i) {
      points.push_back(candidate(drawn({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)})));
    }
    found += Found(points, PlaneSearchSettings{}, static_cast<std::uint32_t>(trial)).any ? 1 : 0;
  }
  std::printf("%d planes in 200 clouds of 100 points\n", found);
  TEST_ASSERT_TRUE(found <= 2);
}

void test_search_should_find_nothing_when_the_layer_is_thicker_than_the_distance() {
  SeededRandom random(63);
  PlaneSearchSettings settings;
  settings.normal_variance = 1;
  settings.chi2 = Scalar(1e6);
  for (int trial = 0; trial < 50; ++trial) {
    // A book shelf: 60 points within 4 cm of a plane, of which some 15 lie within 1 cm.
    std::vector<PlaneCandidate> points;
    for (int i = 0; i < 60; ++i) {
      points.push_back(
          candidate(drawn({random.uniform(-0.04, 0.04), random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6)})));
    }
    TEST_ASSERT_FALSE(Found(points, settings).any);
  }
}

void test_search_should_find_nothing_when_points_are_in_line() {
  SeededRandom random(64);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<PlaneCandidate> points;
    for (int i = 0; i < 30; ++i) {
      points.push_back(candidate(drawn({0.002 * random.normal(), 0.02 * random.normal(), random.uniform(-0.6, 0.6)})));
    }
    TEST_ASSERT_FALSE(Found(points, PlaneSearchSettings{}).any);
  }
}

void test_search_should_leave_a_point_out_when_it_alone_would_turn_the_plane() {
  SeededRandom random(65);
  int tried = 0;
  for (int trial = 0; trial < 40; ++trial) {
    // A patch 24 cm wide, and one point far aside that a plane turned by two degrees would hold.
    std::vector<PlaneCandidate> points;
    for (int i = 0; i < 12; ++i) {
      points.push_back(
          candidate(drawn({0.001 * random.normal(), random.uniform(-0.12, 0.12), random.uniform(-0.12, 0.12)})));
    }
    points.push_back(candidate(at(0.45, 0, 0.018)));
    const Found found(points, PlaneSearchSettings{});
    if (!found.any) continue;
    ++tried;
    for (int k = 0; k < found.count; ++k) TEST_ASSERT_TRUE(found.members[k] < 12);
  }
  TEST_ASSERT_TRUE(tried >= 35);
}

void test_search_should_keep_to_one_group_when_two_lie_in_the_same_plane_far_apart() {
  SeededRandom random(66);
  std::vector<PlaneCandidate> points;
  for (int i = 0; i < 24; ++i) {
    const double x = i < 14 ? -0.5 : 0.4;
    points.push_back(
        candidate(drawn({0.001 * random.normal(), random.uniform(-0.15, 0.15), x + random.uniform(-0.15, 0.15)})));
  }
  const Found found(points, PlaneSearchSettings{});
  TEST_ASSERT_TRUE(found.any);
  for (int k = 0; k < found.count; ++k) TEST_ASSERT_SAME((found.members[0] < 14), (found.members[k] < 14));
}

void test_search_should_need_more_points_than_the_least_when_they_are_few() {
  SeededRandom random(67);
  std::vector<PlaneCandidate> points;
  add_wall(random, 12, &points);
  PlaneSearchSettings settings;
  settings.min_points = 12;
  TEST_ASSERT_FALSE(Found(points, settings).any);
  settings.min_points = 9;
  TEST_ASSERT_TRUE(Found(points, settings).any);
}

void test_search_should_take_the_nearest_when_a_plane_has_very_many_points() {
  SeededRandom random(68);
  std::vector<PlaneCandidate> points;
  add_wall(random, 500, &points);
  const Found found(points, PlaneSearchSettings{});
  TEST_ASSERT_TRUE(found.any);
  TEST_ASSERT_EQUAL_INT(kMaxPlaneMembers, found.count);
}

void test_search_should_answer_the_same_when_the_seed_is_the_same() {
  SeededRandom random(69);
  std::vector<PlaneCandidate> points;
  add_wall(random, 20, &points);
  for (int i = 0; i < 30; ++i) points.push_back(candidate(random.normals<3>(0.5)));
  const Found a(points, PlaneSearchSettings{}, 0), b(points, PlaneSearchSettings{}, 0);
  TEST_ASSERT_TRUE(a.any);
  TEST_ASSERT_TRUE(b.any);
  TEST_ASSERT_SAME(b.count, a.count);
  TEST_ASSERT_SAME(b.fit.frame.R_WP, a.fit.frame.R_WP);
  TEST_ASSERT_SAME(b.fit.frame.o_W, a.fit.frame.o_W);
  TEST_ASSERT_EQUAL_INT(0, std::memcmp(a.members, b.members, sizeof(int) * static_cast<std::size_t>(a.count)));
}

void test_search_should_find_the_same_when_there_is_one_point_more_elsewhere() {
  // Walls that some searches miss: which ones do must not depend on a point that is near none of the sets that are drawn.
  SeededRandom random(71);
  PlaneSearchSettings settings;
  settings.trials = 10;
  int found = 0, alike = 0;
  for (std::uint32_t search = 0; search < 200; ++search) {
    std::vector<PlaneCandidate> points;
    add_wall(random, 12, &points);
    for (int i = 0; i < 30; ++i) {
      points.push_back(candidate(drawn({random.uniform(0.1, 1.5), random.uniform(-1, 1), random.uniform(-1, 1)})));
    }
    const Found before(points, settings, search);
    points.push_back(candidate(at(5, 5, 5)));
    const Found after(points, settings, search);
    const std::size_t members = sizeof(int) * static_cast<std::size_t>(before.count);
    found += before.any ? 1 : 0;
    alike += before.any == after.any && before.count == after.count &&
                     std::memcmp(before.members, after.members, members) == 0
                 ? 1
                 : 0;
  }
  std::printf("%d of 200 searches find the wall, %d find the same with one point more\n", found, alike);
  TEST_ASSERT_TRUE(found > 60 && found < 140);
  TEST_ASSERT_TRUE(alike >= 190);
}

void test_search_should_leave_its_outputs_when_it_finds_nothing() {
  const Scalar nan = std::numeric_limits<Scalar>::quiet_NaN();
  std::vector<PlaneCandidate> points(20, candidate(Vec3(1, 2, 3)));
  for (int i = 0; i < 10; ++i) points.push_back(candidate(Vec3(nan, 0, nan)));
  for (int size : {0, 2, 20, 30}) {
    const std::vector<PlaneCandidate> some(points.begin(), points.begin() + size);
    const Found found(some, PlaneSearchSettings{});
    TEST_ASSERT_FALSE(found.any);
    TEST_ASSERT_EQUAL_INT(0, found.count);
    TEST_ASSERT_EQUAL_INT(0, found.fit.count);
  }
}

void test_search_should_find_the_wall_when_some_points_are_not_numbers() {
  SeededRandom random(70);
  const Scalar nan = std::numeric_limits<Scalar>::quiet_NaN();
  std::vector<PlaneCandidate> points;
  add_wall(random, 20, &points);
  for (int i = 0; i < 5; ++i) points.push_back(candidate(Vec3(nan, 0, static_cast<Scalar>(i))));
  points.push_back({Vec3::Zero(), Mat3::Constant(nan), 0});
  const Found found(points, PlaneSearchSettings{});
  TEST_ASSERT_TRUE(found.any);
  for (int k = 0; k < found.count; ++k) TEST_ASSERT_TRUE(found.members[k] < 20);
}

void test_false_planes_should_be_counted_as_by_hand_when_numbers_are_small() {
  // On 5 of 7, share 1/4: P(X >= 2), X ~ Binomial(4, 1/4) = 1 - (3/4)^4 - 4 (1/4)(3/4)^3 = 67/256; C(10, 3) = 120 sets.
  const Scalar tolerance = sizeof(Scalar) == 4 ? Scalar(1e-5) : Scalar(1e-12);
  const Scalar expected = static_cast<Scalar>(std::log(67.0 / 256 * 120));
  TEST_ASSERT_TRUE(std::abs(log_false_alarms(5, 7, Scalar(0.25), 10) - expected) < tolerance);
  // All of 8: share^5.
  const Scalar all = static_cast<Scalar>(std::log(std::pow(0.05, 5) * 56));
  TEST_ASSERT_TRUE(std::abs(log_false_alarms(8, 8, Scalar(0.05), 8) - all) < 100 * tolerance);
  TEST_ASSERT_SAME(0, log_false_alarms(3, 8, Scalar(0.05), 8));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_search_should_find_the_wall_when_clutter_stands_before_it);
  RUN_TEST(test_search_should_find_nothing_when_there_is_only_clutter);
  RUN_TEST(test_search_should_find_nothing_when_the_layer_is_thicker_than_the_distance);
  RUN_TEST(test_search_should_find_nothing_when_points_are_in_line);
  RUN_TEST(test_search_should_leave_a_point_out_when_it_alone_would_turn_the_plane);
  RUN_TEST(test_search_should_keep_to_one_group_when_two_lie_in_the_same_plane_far_apart);
  RUN_TEST(test_search_should_need_more_points_than_the_least_when_they_are_few);
  RUN_TEST(test_search_should_take_the_nearest_when_a_plane_has_very_many_points);
  RUN_TEST(test_search_should_answer_the_same_when_the_seed_is_the_same);
  RUN_TEST(test_search_should_find_the_same_when_there_is_one_point_more_elsewhere);
  RUN_TEST(test_search_should_leave_its_outputs_when_it_finds_nothing);
  RUN_TEST(test_search_should_find_the_wall_when_some_points_are_not_numbers);
  RUN_TEST(test_false_planes_should_be_counted_as_by_hand_when_numbers_are_small);
  return UNITY_END();
}
