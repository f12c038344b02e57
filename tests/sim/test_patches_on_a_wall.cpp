// Patches of a wall whose plan is wrong, on rendered frames of one textured wall: tracked without points, refined, found again after the
// dark, and without influence where there is no wall.
#include <planefold/planefold.h>
#include <planefold_platform/sim.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr double kWrongRad = 0.05;  // of the plan's normal, about the vertical
constexpr int kPatches = 6;

class Run {
 public:
  Run(int frames, int patches, bool points, bool wall) : sim_(open(frames), pf_sim_close) {
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config_));
    pf_sim_camera(sim_.get(), &config_.camera);
    config_.capacity.max_patches = patches;
    config_.capacity.patch_side_px = 64;
    if (!points) config_.map.features_in_view = 0;
    pf_memory_t need;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config_, &need));
    block_.reset(std::aligned_alloc(need.alignment, (need.bytes + need.alignment) / need.alignment * need.alignment));
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config_, block_.get(), need.bytes, &slam));
    start(wall);
  }

  void start(bool wall) {
    pf_sim_rewind(sim_.get());
    pf_pose_t first;
    pf_sim_pose_at(sim_.get(), 0, &first);
    double velocities[36] = {};
    for (int i = 0; i < 6; ++i) {
      first.covariance[7 * i] = 1e-6;
      velocities[7 * i] = 1e-2;
    }
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_pose(slam, &first, velocities));
    if (!wall) return;
    pf_plane_prior_t prior = {};
    const double c = std::cos(kWrongRad), s = std::sin(kWrongRad);
    const double R[9] = {-c, 0, s, 0, 1, 0, -s, 0, -c};  // z towards the camera, which looks along z of W
    std::memcpy(prior.R_WP, R, sizeof R);
    prior.covariance[0] = prior.covariance[4] = kWrongRad * kWrongRad;
    prior.covariance[8] = 1e-6;
    const double corner[4][2] = {{-2.5, -1.8}, {2.5, -1.8}, {2.5, 1.8}, {-2.5, 1.8}};
    prior.outline_count = 4;
    std::memcpy(prior.outline_P, corner, sizeof corner);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_plane_prior(slam, &prior, &wall_));
  }

  /// The next frame, or darkness in its place.
  pf_status_t step(bool dark = false) {
    pf_image_t image;
    pf_pose_t truth;
    TEST_ASSERT_EQUAL_INT(1, pf_sim_next(sim_.get(), &image, &truth));
    const std::vector<std::uint8_t> black(static_cast<std::size_t>(image.stride * image.height));
    if (dark) image.pixels = black.data();
    const pf_status_t status = pf_push_frame(slam, &image);
    TEST_ASSERT_TRUE(status >= PF_OK);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &pose));
    double square = 0;
    for (int i = 0; i < 3; ++i) square += std::pow(pose.p_WC[i] - truth.p_WC[i], 2);
    error_m = std::sqrt(square);
    return status;
  }

  double wall_error() const {
    pf_plane_t plane;
    std::size_t count;
    TEST_ASSERT_TRUE(pf_get_planes(slam, &plane, 1, &count) >= PF_OK && count >= 1 && plane.id == wall_);
    return std::acos(std::fabs(plane.normal_W[2]));
  }

  std::vector<pf_patch_t> patches() const {
    std::vector<pf_patch_t> all(kPatches);
    std::size_t count;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_patches(slam, all.data(), all.size(), &count));
    all.resize(count);
    return all;
  }

  pf_slam_t* slam = nullptr;
  pf_pose_t pose;
  double error_m = 0;

 private:
  static pf_sim_t* open(int frames) {
    pf_sim_options_t options;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_options_default("wall", &options));
    options.seed = 5;
    options.frames = frames;
    options.samples = 1;
    pf_sim_t* sim = pf_sim_open("wall", &options);
    TEST_ASSERT_NOT_NULL(sim);
    return sim;
  }

  std::unique_ptr<pf_sim_t, void (*)(pf_sim_t*)> sim_;
  pf_config_t config_;
  std::unique_ptr<void, void (*)(void*)> block_{nullptr, std::free};
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
  TEST_ASSERT_TRUE(report.features == 0 && report.cameras > 0 && report.cameras <= report.patches);
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
  RUN_TEST(test_patches_without_a_wall_should_change_nothing);
  RUN_TEST(test_reset_should_drop_patches_and_begin_the_same_again);
  return UNITY_END();
}
