// Runs that go on from saves of themselves, after each few frames, in a block that holds nothing else: each frame gives the bits of a run
// that was never saved. Starts, losses, anchors, marks, masks, places, walls and patches are in them.
#include <algorithm>
#include <cstdio>
#include <vector>

#include "planefold/planefold.h"
#include "support/continued.h"
#include "support/rendered_run.h"
#include "support/wall_walk.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

using Numbers = std::vector<std::vector<double>>;

struct Events {
  int black_from = 1000, black_to = 1000;  ///< frames
  int told = 1000;                         ///< frame before which a pose is marked and an anchor is set
};

/// every: frames from save to save; 0: none.
Numbers run(RenderedRun& rendered, const Events& events, int length, int every) {
  Numbers all;
  for (int k = 0; k < length; ++k) {
    if (k == events.told) {
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_mark_pose(rendered.slam));
      pf_pose_t pose;
      std::uint32_t id;
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(rendered.slam, &pose));
      pose.p_WC[1] += 0.1;
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_anchor_pose(rendered.slam, &pose, &id));
    }
    TEST_ASSERT_TRUE(rendered.step(k >= events.black_from && k < events.black_to ? 1 : -1));
    if (every > 0 && k % every == 0) continue_anew(rendered.config, rendered.need.bytes, rendered.slam);
    all.push_back(numbers_of(rendered.slam));
  }
  return all;
}

void expect_the_same(const Numbers& plain, const Numbers& continued) {
  TEST_ASSERT_EQUAL_size_t(plain.size(), continued.size());
  for (std::size_t k = 0; k < plain.size(); ++k) {
    if (plain[k] != continued[k]) std::printf("frame %zu differs\n", k);
    TEST_ASSERT_TRUE(plain[k] == continued[k]);
  }
}

template <typename Prepare>
void expect_that_it_goes_on(const char* scene, const Events& events, int length, int every, Prepare&& prepare) {
  Numbers all[2];
  for (int k = 0; k < 2; ++k) {
    RenderedRun rendered(scene, length, RenderedRun::Start::kNone);
    prepare(&rendered.config);
    rendered.create();
    all[k] = run(rendered, events, length, k * every);
  }
  expect_the_same(all[0], all[1]);
}

void test_a_run_with_places_and_a_loss_should_go_on() {
  Events events;
  events.told = 80;
  events.black_from = 100;
  events.black_to = 112;
  expect_that_it_goes_on("room", events, 150, 3, [](pf_config_t* config) {
    config->capacity.max_places = 16;
    config->motion.coast_s = 0.2;
  });
}

void test_a_run_with_templates_and_an_open_lens_should_go_on() {
  expect_that_it_goes_on("desk", Events(), 60, 1, [](pf_config_t* config) {
    config->map.masks = PF_MASKS_PARTIAL;
    config->camera.estimate = PF_CAMERA_ESTIMATE;
    config->camera.sigma_focal = 0.01;
    config->camera.sigma_aspect = 0.001;
    config->camera.sigma_centre_px = 5;
  });
}

void test_a_walk_before_a_wall_with_patches_should_go_on() {
  Numbers all[2];
  for (int continued = 0; continued < 2; ++continued) {
    WallWalk walk(60, 6, 20);
    pf_wall_prior_t wall = WallWalk::wall(0, 1.8);
    for (int i = 0; i < 3; ++i) wall.covariance[4 * i] = 1e-4;
    walk.add(wall);
    pf_memory_t need;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&walk.config(), &need));
    bool has_patches = false;
    for (int k = 0; k < 50; ++k) {
      walk.step(k > 30 && k < 36);
      if (continued > 0) continue_anew(walk.config(), need.bytes, walk.slam);
      all[continued].push_back(numbers_of(walk.slam));
      pf_report_t report;
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(walk.slam, &report));
      has_patches = has_patches || report.patches > 0;
    }
    TEST_ASSERT_TRUE(has_patches);
  }
  expect_the_same(all[0], all[1]);
}

void test_a_walk_before_a_wall_in_the_window_should_go_on() {
  Numbers all[2];
  for (int continued = 0; continued < 2; ++continued) {
    WallWalk walk(160, 0, 100, PF_BACKEND_WINDOW);
    pf_wall_prior_t wall = WallWalk::wall(0.02, 1.8);
    for (int i = 0; i < 3; ++i) wall.covariance[4 * i] = 1e-3;
    walk.add(wall);
    pf_memory_t need;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&walk.config(), &need));
    int on_wall = 0;
    for (int k = 0; k < 150; ++k) {
      walk.step(k > 100 && k < 104);
      if (continued > 0 && k % 5 == 0) continue_anew(walk.config(), need.bytes, walk.slam);
      all[continued].push_back(numbers_of(walk.slam));
      pf_plane_t plane;
      std::size_t count = 0;
      if (pf_get_planes(walk.slam, &plane, 1, &count) == PF_OK && count > 0 && plane.is_wall != 0)
        on_wall = std::max(on_wall, static_cast<int>(plane.points));
    }
    std::printf("at most %d points on the wall\n", on_wall);
    TEST_ASSERT_TRUE(on_wall > 0);
  }
  expect_the_same(all[0], all[1]);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  for (const pf_backend_t backend : {PF_BACKEND_WINDOW, PF_BACKEND_FILTER}) {
    RenderedRun::backend = backend;
    RUN_TEST(test_a_run_with_places_and_a_loss_should_go_on);
    RUN_TEST(test_a_run_with_templates_and_an_open_lens_should_go_on);
  }
  RUN_TEST(test_a_walk_before_a_wall_with_patches_should_go_on);
  RUN_TEST(test_a_walk_before_a_wall_in_the_window_should_go_on);
  return UNITY_END();
}
