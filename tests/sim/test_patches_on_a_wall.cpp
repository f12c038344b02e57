// Patches of a wall whose plan is wrong, on rendered frames of one textured wall: tracked without points, refined, found again after the
// dark, and without influence where there is no wall.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "same.h"
#include "support/wall_walk.h"

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr double kWrongRad = 0.05;  // of the plan's normal, about the vertical
constexpr int kPatches = 6;

class Run : public WallWalk {
 public:
  Run(int frames, int patches, bool points, bool has_wall) : WallWalk(frames, patches, points ? -1 : 0) {
    if (has_wall) add_wall();
  }

  void start(bool has_wall) {
    WallWalk::start();
    if (has_wall) add_wall();
  }

  double wall_error() const {
    pf_plane_t plane;
    std::size_t count;
    TEST_ASSERT_TRUE(pf_get_planes(slam, &plane, 1, &count) >= PF_OK);
    TEST_ASSERT_TRUE(count >= 1);
    TEST_ASSERT_SAME(wall_, plane.id);
    return std::acos(std::fabs(plane.normal_W[2]));
  }

 private:
  void add_wall() {
    pf_wall_prior_t prior = wall(kWrongRad, 2.5);
    prior.covariance[0] = prior.covariance[4] = kWrongRad * kWrongRad;
    prior.covariance[8] = 1e-6;
    wall_ = add(prior);
  }

  std::uint32_t wall_ = 0;
};

void test_a_wall_alone_should_be_tracked_and_refined() {
  constexpr int kFrames = 150;
  Run run(kFrames, kPatches, false, true);
  double worst = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    const pf_status_t status = run.step();
    if (frame > 0) TEST_ASSERT_EQUAL_INT(PF_OK, status);
    worst = std::max(worst, run.error_m);
  }
  std::printf("worst error %.4f m, wall off by %.4f rad\n", worst, run.wall_error());
  TEST_ASSERT_TRUE(worst < 0.03);
  TEST_ASSERT_TRUE(run.wall_error() < 0.3 * kWrongRad);
  pf_report_t report;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(run.slam, &report));
  const std::vector<pf_patch_t> patches = run.patches();
  TEST_ASSERT_EQUAL_INT(report.patches, static_cast<int>(patches.size()));
  TEST_ASSERT_SAME(0, report.features);
  TEST_ASSERT_TRUE(report.cameras > 0);
  TEST_ASSERT_TRUE(report.cameras <= report.patches);
  int inliers = 0;
  for (const pf_patch_t& p : patches) {
    inliers += p.status == PF_MATCH_INLIER;
    TEST_ASSERT_TRUE(p.status >= 0 && p.status <= PF_PATCH_WAITING && p.weight >= 0 && p.weight <= 1);
    if (p.status == PF_MATCH_INLIER) TEST_ASSERT_TRUE(p.covariance_px[0] > 0 && p.covariance_px[0] < 1 && p.frames > 0);
  }
  TEST_ASSERT_EQUAL_INT(report.inliers, 8 * inliers);
}

void test_patches_should_be_found_again_after_the_dark() {
  Run run(120, kPatches, false, true);
  for (int frame = 0; frame < 60; ++frame) run.step();
  for (int frame = 0; frame < 30; ++frame) TEST_ASSERT_NOT_EQUAL(PF_OK, run.step(true));
  int since = 0;
  while (since < 20 && run.step() != PF_OK) ++since;
  std::printf("tracked again after %d frames of light, %.4f m off\n", since, run.error_m);
  TEST_ASSERT_TRUE(since < 10 && run.error_m < 0.03);
}

/// The first patch that is taken in has no gate but the motion's, which is wider than what it is moved by.
void test_a_gross_patch_should_be_refused_by_the_others_though_it_is_the_most_proven() {
  constexpr int kFrames = 150;
  Run run(kFrames, kPatches, false, true);
  int told = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    const std::vector<pf_patch_t> before = run.patches();
    const auto most = std::max_element(before.begin(), before.end(),
                                       [](const auto& a, const auto& b) { return a.frames < b.frames; });
    const auto inliers = std::count_if(before.begin(), before.end(),
                                       [](const auto& p) { return p.status == PF_MATCH_INLIER && p.frames > 10; });
    const bool spoils = frame % 7 == 0 && inliers >= 3 && most->status == PF_MATCH_INLIER;
    const pf_status_t status = run.step(false, spoils ? &*most : nullptr);
    if (!spoils) continue;
    TEST_ASSERT_EQUAL_INT(PF_OK, status);
    int refused = 0, taken = 0;
    for (const pf_patch_t& p : run.patches()) {
      refused += p.id == most->id && p.status != PF_MATCH_INLIER;
      taken += p.id != most->id && p.status == PF_MATCH_INLIER;
    }
    std::printf("frame %d: %d of %d others taken, %.4f m off\n", frame, taken, static_cast<int>(inliers) - 1,
                run.error_m);
    TEST_ASSERT_SAME(1, refused);
    TEST_ASSERT_TRUE(taken >= 1);
    TEST_ASSERT_TRUE(run.error_m < 0.03);
    ++told;
  }
  TEST_ASSERT_TRUE(told >= 2);
}

void test_patches_without_a_wall_should_change_nothing() {
  Run with(25, kPatches, true, false), without(25, 0, true, false);
  for (int frame = 0; frame < 25; ++frame) {
    TEST_ASSERT_EQUAL_INT(without.step(), with.step());
    TEST_ASSERT_EQUAL_MEMORY(&without.pose, &with.pose, sizeof with.pose);
  }
  TEST_ASSERT_TRUE(with.patches().empty());
}

void test_reset_should_drop_patches_and_begin_the_same_again() {
  Run run(40, kPatches, false, true);
  for (int frame = 0; frame < 20; ++frame) run.step();
  const pf_pose_t first = run.pose;
  TEST_ASSERT_FALSE(run.patches().empty());
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(run.slam));
  TEST_ASSERT_TRUE(run.patches().empty());
  run.start(true);
  for (int frame = 0; frame < 20; ++frame) run.step();
  TEST_ASSERT_EQUAL_MEMORY(&first, &run.pose, sizeof first);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_a_wall_alone_should_be_tracked_and_refined);
  RUN_TEST(test_patches_should_be_found_again_after_the_dark);
  RUN_TEST(test_a_gross_patch_should_be_refused_by_the_others_though_it_is_the_most_proven);
  RUN_TEST(test_patches_without_a_wall_should_change_nothing);
  RUN_TEST(test_reset_should_drop_patches_and_begin_the_same_again);
  return UNITY_END();
}
