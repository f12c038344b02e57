// Which wall a patch lies on, on rendered frames of one textured wall: of two walls of the plan, one before the other, patches join the one
// that is there; and where the plan has none, a patch founds it.
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

constexpr int kFrames = 150, kPatches = 8;

class Run {
 public:
  explicit Run(int features) : sim_(open(), pf_sim_close) {
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config_));
    pf_sim_camera(sim_.get(), &config_.camera);
    config_.capacity.max_patches = kPatches;
    config_.capacity.patch_side_px = 64;
    config_.map.features_in_view = features;
    pf_memory_t need;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config_, &need));
    block_.reset(std::aligned_alloc(need.alignment, (need.bytes + need.alignment) / need.alignment * need.alignment));
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config_, block_.get(), need.bytes, &slam));
    pf_pose_t first;
    pf_sim_pose_at(sim_.get(), 0, &first);
    double velocities[36] = {};
    for (int i = 0; i < 6; ++i) {
      first.covariance[7 * i] = 1e-6;
      velocities[7 * i] = 1e-2;
    }
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_pose(slam, &first, velocities));
  }

  /// A wall parallel to the one that is there, before it by so much; x: of its middle.
  std::uint32_t add_wall(double before, double x, double half_width) {
    pf_plane_prior_t prior = {};
    const double R[9] = {-1, 0, 0, 0, 1, 0, 0, 0, -1};  // z towards the camera, which looks along z of W
    std::memcpy(prior.R_WP, R, sizeof R);
    prior.p_WP[0] = x;
    prior.p_WP[2] = -before;
    prior.covariance[0] = prior.covariance[4] = 1e-4;
    prior.covariance[8] = 1e-4;
    const double corner[4][2] = {{-half_width, -1.8}, {half_width, -1.8}, {half_width, 1.8}, {-half_width, 1.8}};
    prior.outline_count = 4;
    std::memcpy(prior.outline_P, corner, sizeof corner);
    std::uint32_t id;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_plane_prior(slam, &prior, &id));
    return id;
  }

  void step() {
    pf_image_t image;
    pf_pose_t truth, pose;
    TEST_ASSERT_EQUAL_INT(1, pf_sim_next(sim_.get(), &image, &truth));
    TEST_ASSERT_TRUE(pf_push_frame(slam, &image) >= PF_OK);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &pose));
    double square = 0;
    for (int i = 0; i < 3; ++i) square += std::pow(pose.p_WC[i] - truth.p_WC[i], 2);
    worst_m = std::max(worst_m, std::sqrt(square));
  }

  std::vector<pf_patch_t> patches() const {
    std::vector<pf_patch_t> all(kPatches);
    std::size_t count;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_patches(slam, all.data(), all.size(), &count));
    all.resize(count);
    return all;
  }
  int inliers_on(std::uint32_t plane) const {
    const std::vector<pf_patch_t> all = patches();
    return static_cast<int>(std::count_if(
        all.begin(), all.end(), [&](const pf_patch_t& p) { return p.status == PF_MATCH_INLIER && p.plane == plane; }));
  }

  pf_slam_t* slam = nullptr;
  double worst_m = 0;

 private:
  static pf_sim_t* open() {
    pf_sim_options_t options;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_options_default("wall", &options));
    options.seed = 5;
    options.frames = kFrames;
    options.samples = 1;
    pf_sim_t* sim = pf_sim_open("wall", &options);
    TEST_ASSERT_NOT_NULL(sim);
    return sim;
  }

  std::unique_ptr<pf_sim_t, void (*)(pf_sim_t*)> sim_;
  pf_config_t config_;
  std::unique_ptr<void, void (*)(void*)> block_{nullptr, std::free};
};

void test_of_two_walls_patches_should_join_the_one_that_is_there() {
  Run run(40);
  // What is beside the one that is not there tells the scale of the world.
  const std::uint32_t there = run.add_wall(0, 0, 2.5), before = run.add_wall(0.1, -1.3, 1.25);
  int waited = 0, on_it = 0, off = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    run.step();
    for (const pf_patch_t& p : run.patches()) {
      if (p.status != PF_PATCH_WAITING) continue;
      ++waited;
      TEST_ASSERT_EQUAL_UINT32(0, p.plane);
      TEST_ASSERT_EQUAL_INT(0, p.frames);
      TEST_ASSERT_TRUE(p.covariance_px[0] > 0);
    }
    on_it += run.inliers_on(there);
    off += run.inliers_on(before);
  }
  std::printf("%d frames of patches waited, %d on the wall, %d off it, worst error %.4f m\n", waited, on_it, off,
              run.worst_m);
  TEST_ASSERT_TRUE(waited > 0 && on_it > kFrames && off == 0);
  TEST_ASSERT_TRUE(run.worst_m < 0.03);
}

void test_a_wall_that_the_plan_does_not_have_should_be_founded() {
  Run run(0);
  const std::uint32_t half = run.add_wall(0, -1.3, 1.25);
  int measured = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    run.step();
    for (const pf_patch_t& p : run.patches()) measured += p.status == PF_MATCH_INLIER;
  }
  pf_plane_t planes[16];
  std::size_t count;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_planes(run.slam, planes, 16, &count));
  int with_patches = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (planes[i].id == half || run.inliers_on(planes[i].id) == 0) continue;
    ++with_patches;
    const double angle = std::acos(std::min(1.0, std::fabs(planes[i].normal_W[2])));
    std::printf("plane %u: %.4f rad, %.4f m off, %d points\n", planes[i].id, angle, planes[i].distance,
                planes[i].points);
    TEST_ASSERT_TRUE(angle < 0.05 && std::fabs(planes[i].distance) < 0.05);
  }
  std::printf("%d measurements of patches, worst error %.4f m\n", measured, run.worst_m);
  TEST_ASSERT_TRUE(with_patches > 0 && measured > kFrames / 2);
  TEST_ASSERT_TRUE(run.worst_m < 0.05);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_of_two_walls_patches_should_join_the_one_that_is_there);
  RUN_TEST(test_a_wall_that_the_plan_does_not_have_should_be_founded);
  return UNITY_END();
}
