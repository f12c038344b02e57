// Which wall a patch lies on, on rendered frames of one textured wall: of two walls of the plan, one before the other, patches join the one
// that is there; and where the plan has none, a patch founds it.
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

constexpr int kFrames = 150, kPatches = 8;

class Run : public WallWalk {
 public:
  explicit Run(int features) : WallWalk(kFrames, kPatches, features) {}

  /// A wall parallel to the one that is there, before it by so much; x: of its middle.
  std::uint32_t add_wall(double before, double x, double half_width) {
    pf_wall_prior_t prior = wall(0, half_width);
    prior.p_WP[0] = x;
    prior.p_WP[2] = -before;
    prior.covariance[0] = prior.covariance[4] = prior.covariance[8] = 1e-4;
    return add(prior);
  }

  void step() {
    WallWalk::step();
    worst_m = std::max(worst_m, error_m);
  }

  int inliers_on(std::uint32_t plane) const {
    const std::vector<pf_patch_t> all = patches();
    return static_cast<int>(std::count_if(
        all.begin(), all.end(), [&](const pf_patch_t& p) { return p.status == PF_MATCH_INLIER && p.plane == plane; }));
  }

  double worst_m = 0;
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
  TEST_ASSERT_TRUE(waited > 0);
  TEST_ASSERT_TRUE(on_it > kFrames);
  TEST_ASSERT_SAME(0, off);
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
