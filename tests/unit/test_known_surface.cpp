// What lies on the surface of a target belongs to no other plane: a desk takes nothing of the plate that stands on it.
#include <vector>

#include "map/known_surface.h"
#include "map/plane_search.h"
#include "same.h"
#include "support/seeded_random.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

const Mat3 kCovariance = Mat3::Identity() * Scalar(4e-6);  // 2 mm
constexpr Scalar kRoughness = Scalar(0.002), kGate = Scalar(6.63), kReach = Scalar(0.5);

/// A rectangle of 0.2 by 0.1 m in the plane z = 0.
KnownSurface plate() {
  const Vec3 corner[4] = {{Scalar(-0.1), Scalar(-0.05), 0},
                          {Scalar(0.1), Scalar(-0.05), 0},
                          {Scalar(0.1), Scalar(0.05), 0},
                          {Scalar(-0.1), Scalar(0.05), 0}};
  return known_surface(Vec3(0, 0, -1), corner, 4, kReach);
}

bool is_on(const KnownSurface& surface, double x, double y, double z) {
  const Vec3 p_W(static_cast<Scalar>(x), static_cast<Scalar>(y), static_cast<Scalar>(z));
  return explains(surface, p_W, kCovariance, kRoughness, kGate);
}

void test_surface_should_explain_what_lies_on_it_and_near_its_points() {
  const KnownSurface surface = plate();  // half of its size, 0.0707 m, beyond the outline
  TEST_ASSERT_TRUE(is_on(surface, 0, 0, 0));
  TEST_ASSERT_TRUE(is_on(surface, 0.165, 0.0, 0.005));
  TEST_ASSERT_TRUE(is_on(surface, 0, 0.115, -0.005));
  TEST_ASSERT_FALSE(is_on(surface, 0.175, 0, 0));
  TEST_ASSERT_FALSE(is_on(surface, 0, 0.125, 0));
  TEST_ASSERT_FALSE(is_on(surface, 0, 0, 0.01));
  TEST_ASSERT_FALSE(is_on(surface, 0, 0, -0.01));
  TEST_ASSERT_TRUE(may_be_plane(surface, Vec3(0, 0, 1)));
  TEST_ASSERT_FALSE(may_be_plane(surface, Vec3(0, 1, 0)));
}

void test_surface_should_explain_nothing_where_there_is_none() {
  const Vec3 points[3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  TEST_ASSERT_FALSE(is_on(KnownSurface(), 0, 0, 0));
  TEST_ASSERT_FALSE(is_on(known_surface(Vec3::Zero(), points, 3, kReach), 0, 0, 0));
  TEST_ASSERT_FALSE(is_on(known_surface(Vec3(0, 0, 1), points, 2, kReach), 0, 0, 0));
  TEST_ASSERT_FALSE(is_on(known_surface(Vec3(0, 0, 1), points, 3, kReach), 0, 0, 0));  // they are on a line
}

/// A plane through y = 0.1, and one point 8 mm above it that is on the plate.
void test_plane_should_not_take_what_the_surface_explains() {
  SeededRandom random(1);
  std::vector<PlaneCandidate> candidates;
  const KnownSurface surface = plate();
  for (int i = 0; i < 20; ++i) {
    const Vec3 p_W(static_cast<Scalar>(random.uniform(-0.2, 0.2)), Scalar(0.1),
                   static_cast<Scalar>(random.uniform(-0.4, -0.05)));
    candidates.push_back({p_W, kCovariance, i});
  }
  candidates.push_back({Vec3(0, Scalar(0.092), 0), kCovariance, 20});
  for (const bool is_known : {false, true}) {
    for (PlaneCandidate& c : candidates)
      c.is_explained = is_known && explains(surface, c.p_W, c.covariance, kRoughness, kGate);
    TEST_ASSERT_SAME(is_known, candidates.back().is_explained);
    PlaneSearchSettings settings;
    settings.known = &surface;
    PlaneFit fit;
    int members[kMaxPlaneMembers], count = 0;
    TEST_ASSERT_TRUE(search_plane(candidates.data(), 21, settings, Vec3(0, -1, -1), 7, &fit, members, &count));
    bool has_it = false;
    for (int k = 0; k < count; ++k) has_it = has_it || members[k] == 20;
    TEST_ASSERT_SAME(!is_known, has_it);
  }
}

/// A wall that carries the target is made of what the target's surface explains.
void test_plane_should_be_found_when_it_is_the_surface() {
  SeededRandom random(2);
  std::vector<PlaneCandidate> candidates;
  const KnownSurface surface = plate();
  for (int i = 0; i < 20; ++i) {
    const Vec3 p_W(static_cast<Scalar>(random.uniform(-0.15, 0.15)), static_cast<Scalar>(random.uniform(-0.1, 0.1)), 0);
    candidates.push_back({p_W, kCovariance, i});
    candidates.back().is_explained = explains(surface, p_W, kCovariance, kRoughness, kGate);
    TEST_ASSERT_TRUE(candidates.back().is_explained);
  }
  PlaneSearchSettings settings;
  settings.known = &surface;
  PlaneFit fit;
  int members[kMaxPlaneMembers], count = 0;
  TEST_ASSERT_TRUE(search_plane(candidates.data(), 20, settings, Vec3(0, 0, -1), 7, &fit, members, &count));
  TEST_ASSERT_EQUAL_INT(20, count);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_surface_should_explain_what_lies_on_it_and_near_its_points);
  RUN_TEST(test_surface_should_explain_nothing_where_there_is_none);
  RUN_TEST(test_plane_should_not_take_what_the_surface_explains);
  RUN_TEST(test_plane_should_be_found_when_it_is_the_surface);
  return UNITY_END();
}
