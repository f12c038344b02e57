// Features that began on a plane because their corner lies in its outline: what makes them believed, and what makes them go.
#include "belief/plane_membership.h"
#include "filter_slam/planes/plane_trials.h"
#include "same.h"
#include "support/plane_keeper_bench.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr Scalar kDepth = 2;  // of the plane

/// A camera before a plane, and a feature that began on it.
struct Bench : PlaneKeeperBench {
  int entry = -1;
  Vec3 ray_W = Vec3(Scalar(0.1), Scalar(-0.05), 1);

  Bench() {
    const int plane = add_plane();
    Vec2 pixel;
    TEST_ASSERT_TRUE(project(settings.camera, ray_W, &pixel));
    entry = features.add_on_plane(plane, pixel, Mat2::Identity() * Scalar(0.1));
    TEST_ASSERT_TRUE(entry >= 0);
    TEST_ASSERT_TRUE(map.features[entry].on_trial);
    map.first_view(entry) = {Quat::Identity(), Vec3::Zero()};
  }

  int add_plane() {
    PlanePrior wall;
    wall.frame.o_W = Vec3(0, 0, kDepth);
    wall.frame.R_WP << 1, 0, 0, 0, -1, 0, 0, 0, -1;
    wall.covariance = Mat3::Identity() * Scalar(1e-6);
    const Vec2 corners[4] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    wall.outline.count = 4;
    for (int c = 0; c < 4; ++c) wall.outline.uv[c] = corners[c];
    std::uint32_t id = 0;
    TEST_ASSERT_SAME(Status::kOk, planes.add_wall(wall, 0, false, 0, &id));
    for (int i = 0; i < map.planes.capacity(); ++i)
      if (map.planes.used(i)) return map.planes[i].slot;
    return -1;
  }

  /// The camera is so far aside, and finds the feature where a point at this part of the plane's depth is seen.
  void see(Scalar aside, Scalar depth) {
    Body body;
    body.p_W = Vec3(aside, 0, 0);
    filter->set_mean(body);
    frame.begin(33000000 * (frame.report.frames + 1));
    Feature& f = map.features[entry];
    ++f.observations;
    ++f.attempts;
    f.was_missed = false;
    f.rejections = 0;
    f.last_seen_ns = frame.report.t_ns;
    Vec2 z;
    TEST_ASSERT_TRUE(project(settings.camera, Vec3(depth * kDepth * ray_W - body.p_W), &z));
    frame.add(
        {entry, f.id, MatchStatus::kInlier, BlockKind::kPlanePoint, true, false, z, Mat2::Identity(), z, Scalar(1)});
    planes.maintain();
  }
};

void test_feature_should_be_believed_when_its_pixels_keep_to_the_plane() {
  Bench bench;
  for (int k = 1; k <= 15; ++k) bench.see(Scalar(0.02) * Scalar(k), 1);
  TEST_ASSERT_TRUE(bench.map.features.used(bench.entry));
  TEST_ASSERT_FALSE(bench.map.features[bench.entry].on_trial);
}

void test_feature_should_stay_on_trial_when_another_depth_would_not_show() {
  Bench bench;
  for (int k = 1; k <= 30; ++k) bench.see(Scalar(0.001) * Scalar(k), Scalar(0.92));
  TEST_ASSERT_TRUE(bench.map.features.used(bench.entry));
  TEST_ASSERT_TRUE(bench.map.features[bench.entry].on_trial);
}

void test_feature_should_go_when_its_pixels_say_that_it_is_nearer_or_farther() {
  for (const Scalar depth : {Scalar(0.92), Scalar(0.96), Scalar(1.04), Scalar(1.2)}) {
    Bench bench;
    for (int k = 1; k <= 15 && bench.map.features.used(bench.entry); ++k) bench.see(Scalar(0.02) * Scalar(k), depth);
    TEST_ASSERT_FALSE(bench.map.features.used(bench.entry));
  }
}

/// A plane that is rough by a tenth of the depth that would show.
void test_feature_should_be_believed_when_it_is_hardly_off_the_plane() {
  for (const Scalar depth : {Scalar(0.995), Scalar(1.005)}) {
    Bench bench;
    for (int k = 1; k <= 15; ++k) bench.see(Scalar(0.02) * Scalar(k), depth);
    TEST_ASSERT_TRUE(bench.map.features.used(bench.entry));
    TEST_ASSERT_FALSE(bench.map.features[bench.entry].on_trial);
  }
}

void test_log_odds_should_say_nothing_when_there_is_no_parallax() {
  for (const Scalar s : {Scalar(0), Scalar(0.3)}) {
    TEST_ASSERT_TRUE(std::abs(log_odds_on_plane(s, Scalar(25), Scalar(0.01), Scalar(0.5))) < Scalar(0.1));
  }
}

void test_log_odds_should_grow_with_what_is_known_of_the_depth() {
  Scalar before = 0;
  for (const Scalar sigma : {Scalar(0.3), Scalar(0.1), Scalar(0.03), Scalar(0.01)}) {
    const Scalar odds = log_odds_on_plane(Scalar(0), sigma * sigma, Scalar(0.002), Scalar(0.5));
    TEST_ASSERT_TRUE(odds > before);
    TEST_ASSERT_TRUE(log_odds_on_plane(6 * sigma, sigma * sigma, Scalar(0.002), Scalar(0.5)) < odds);
    before = odds;
  }
  TEST_ASSERT_TRUE(before > Scalar(3));
  TEST_ASSERT_TRUE(log_odds_on_plane(Scalar(0.06), Scalar(1e-4), Scalar(0.002), Scalar(0.5)) < Scalar(-10));
}

void test_outliers_of_a_plane_should_count_features_that_began_on_it_and_are_elsewhere() {
  Bench bench;
  const int plane = bench.map.planes.entry_at(bench.filter->state().plane_of(bench.map.features[bench.entry].slot));
  bench.map.planes[plane].outliers = 2;
  for (int k = 1; k <= 15; ++k) bench.see(Scalar(0.02) * Scalar(k), 1);
  TEST_ASSERT_EQUAL_INT(1, bench.map.planes[plane].outliers);
  Bench other;
  for (int k = 1; k <= 15 && other.map.features.used(other.entry); ++k)
    other.see(Scalar(0.02) * Scalar(k), Scalar(0.9));
  TEST_ASSERT_EQUAL_INT(1, other.map.planes[plane].outliers);
}

/// A point of the map that lies on the plane, as certain as the plane is or so much: folded in the next frame or not.
bool is_folded(bool was_missed, int rejections, Scalar sigma = Scalar(1e-3), bool is_found = false) {
  Bench bench;
  if (is_found) bench.map.planes[0].known = false;
  const int slot =
      bench.filter->add_point(Vec3(Scalar(0.3), Scalar(0.2), kDepth), Mat3(Mat3::Identity() * sigma * sigma));
  const int entry = bench.map.features.add(slot);
  TEST_ASSERT_TRUE(slot >= 0 && entry >= 0);
  bench.filter->set_owner(slot, entry);
  Feature& f = bench.map.features[entry];
  f.observations = f.attempts = 20;
  f.was_missed = was_missed;
  f.rejections = static_cast<std::uint8_t>(rejections);
  bench.planes.maintain();
  return is_planar(bench.filter->state().block[slot].kind);
}

void test_point_should_be_folded_when_it_was_missed_but_not_when_it_was_found_elsewhere() {
  TEST_ASSERT_TRUE(is_folded(false, 0));
  TEST_ASSERT_TRUE(is_folded(true, 0));
  TEST_ASSERT_FALSE(is_folded(true, 1));
}

/// Two metres away it is a member where half a metre of depth could have shown it elsewhere a hundred times.
void test_point_should_be_folded_into_a_found_plane_when_its_depth_would_have_shown_it_elsewhere() {
  TEST_ASSERT_TRUE(is_folded(false, 0, Scalar(0.002), true));
  TEST_ASSERT_TRUE(is_folded(false, 0, Scalar(0.005), true));
  TEST_ASSERT_FALSE(is_folded(false, 0, Scalar(0.02), true));
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_feature_should_be_believed_when_its_pixels_keep_to_the_plane);
  RUN_TEST(test_feature_should_stay_on_trial_when_another_depth_would_not_show);
  RUN_TEST(test_feature_should_go_when_its_pixels_say_that_it_is_nearer_or_farther);
  RUN_TEST(test_feature_should_be_believed_when_it_is_hardly_off_the_plane);
  RUN_TEST(test_log_odds_should_say_nothing_when_there_is_no_parallax);
  RUN_TEST(test_log_odds_should_grow_with_what_is_known_of_the_depth);
  RUN_TEST(test_outliers_of_a_plane_should_count_features_that_began_on_it_and_are_elsewhere);
  RUN_TEST(test_point_should_be_folded_when_it_was_missed_but_not_when_it_was_found_elsewhere);
  RUN_TEST(test_point_should_be_folded_into_a_found_plane_when_its_depth_would_have_shown_it_elsewhere);
  return UNITY_END();
}
