/* pf_set_mask: what is refused changes nothing, what it costs is stated, and what is masked is never measured, in both back ends and
 * starts. */
#include <math.h>
#include <planefold/planefold.h>
#include <planefold_platform/sim.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

enum { WIDE = 320, HIGH = 240, FRAMES = 24, CELL = 4 };

static pf_config_t config;
static pf_sim_t* sim;
static unsigned char* raw;
static pf_slam_t* slam;
static uint8_t scene[WIDE * HIGH];

static void close_slam(void) {
  free(raw);
  raw = NULL;
}

static void open_slam(void) {
  pf_memory_t need;
  close_slam();
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
  raw = (unsigned char*)malloc(need.bytes + need.alignment);
  TEST_ASSERT_NOT_NULL(raw);
  TEST_ASSERT_EQUAL_INT(
      PF_OK,
      pf_create(&config, raw + (need.alignment - (uintptr_t)raw % need.alignment) % need.alignment, need.bytes, &slam));
}

void setUp(void) {
  pf_sim_options_t options;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_options_default("desk", &options));
  options.camera.width = WIDE;
  options.camera.height = HIGH;
  options.camera.fx /= 2;
  options.camera.fy /= 2;
  options.camera.cx = 0.5 * (WIDE - 1);
  options.camera.cy = 0.5 * (HIGH - 1);
  sim = pf_sim_open("desk", &options);
  TEST_ASSERT_NOT_NULL(sim);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config));
  pf_sim_camera(sim, &config.camera);
  config.capacity.mask = WIDE * HIGH;
  memset(scene, 255, sizeof scene);
  raw = NULL;
}

void tearDown(void) {
  close_slam();
  pf_sim_close(sim);
}

static pf_mask_t mask_of(const uint8_t* pixels) {
  const pf_mask_t mask = {pixels, WIDE, HIGH, WIDE, 0, NULL};
  return mask;
}

static pf_mask_t mask_of_rectangles(const pf_rectangle_t* rectangles, int count) {
  const pf_mask_t mask = {NULL, WIDE, HIGH, 0, count, rectangles};
  return mask;
}

/* The scene's frames; counts matches that are at or below a row. The last pose goes to *pose. */
static int below(int row, pf_pose_t* pose) {
  pf_image_t image;
  int count = 0;
  pf_sim_rewind(sim);
  for (int k = 0; k < FRAMES && pf_sim_next(sim, &image, NULL); ++k) {
    pf_match_t matches[300];
    size_t n = 0;
    TEST_ASSERT_TRUE(pf_push_frame(slam, &image) >= PF_OK);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_matches(slam, matches, 300, &n));
    for (size_t i = 0; i < n; ++i)
      count += matches[i].status != PF_MATCH_MISSED && matches[i].measured_px[1] >= row - 1;
  }
  memset(pose, 0, sizeof *pose);
  pf_get_pose(slam, pose);
  return count;
}

static void test_what_is_wrong_should_be_refused_and_change_nothing(void) {
  pf_rectangle_t wrong = {0, 0, -1, 5}, all = {-10, -10, 1000, 1000};
  pf_pose_t plain, after;
  pf_mask_t mask = mask_of(scene);
  open_slam();
  below(0, &plain);

  open_slam();
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_set_mask(NULL, &mask));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_set_mask(slam, NULL));
  mask = mask_of(NULL);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_set_mask(slam, &mask));
  mask.num_rectangles = 1;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_set_mask(slam, &mask));
  for (int k = 0; k < 3; ++k) {
    mask = mask_of(scene);
    *(k == 0 ? &mask.width : k == 1 ? &mask.height : &mask.stride) -= 1;
    TEST_ASSERT_EQUAL_INT(PF_ERROR_SIZE, pf_set_mask(slam, &mask));
  }
  mask = mask_of_rectangles(&wrong, 1);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_RANGE, pf_set_mask(slam, &mask));
  mask = mask_of_rectangles(&all, -1);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_RANGE, pf_set_mask(slam, &mask));
  mask = mask_of_rectangles(&all, 1);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_RANGE, pf_set_mask(slam, &mask));
  memset(scene, 0, sizeof scene);
  mask = mask_of(scene);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_RANGE, pf_set_mask(slam, &mask));
  below(0, &after);
  TEST_ASSERT_EQUAL_MEMORY(&plain, &after, sizeof plain);
}

static void test_room_should_be_asked_for_and_be_one_bit_a_cell(void) {
  pf_memory_t with, without;
  const char* field = NULL;
  pf_mask_t mask = mask_of(scene);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &with));
  config.capacity.mask = WIDE * HIGH - 1;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_CONFIG, pf_config_check(&config, &field));
  TEST_ASSERT_EQUAL_STRING("capacity.mask", field);
  config.capacity.mask = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &without));
  TEST_ASSERT_TRUE(with.bytes > without.bytes);
  TEST_ASSERT_TRUE(with.bytes - without.bytes <= WIDE * HIGH / (CELL * CELL * 8) + 128);
  open_slam();
  TEST_ASSERT_EQUAL_INT(PF_ERROR_FULL, pf_set_mask(slam, &mask));
}

static void test_a_mask_should_end_with_one_that_is_all_scene_and_with_a_reset(void) {
  pf_rectangle_t body = {0, HIGH / 2, WIDE, HIGH}, nothing = {5, 5, 0, 0};
  const pf_mask_t masks = mask_of_rectangles(&body, 1), shows = mask_of(scene), none = mask_of_rectangles(&nothing, 1);
  pf_pose_t plain, after;
  open_slam();
  below(0, &plain);
  for (int k = 0; k < 3; ++k) {
    open_slam();
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_set_mask(slam, &masks));
    if (k == 2)
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(slam));
    else
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_set_mask(slam, k == 0 ? &shows : &none));
    below(0, &after);
    TEST_ASSERT_EQUAL_MEMORY(&plain, &after, sizeof plain);
  }
}

static void test_too_little_that_is_left_should_be_noted(void) {
  pf_mask_t mask = mask_of(scene);
  open_slam();
  memset(scene, 0, sizeof scene);
  for (int y = 40; y < 60; ++y) memset(scene + y * WIDE + 80, 255, 20);
  TEST_ASSERT_EQUAL_INT(PF_NOTE_UNUSABLE, pf_set_mask(slam, &mask));
  memset(scene + 40 * WIDE, 255, (size_t)(HIGH / 3) * WIDE);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_set_mask(slam, &mask));
}

static void test_what_is_masked_should_not_be_measured(void) {
  const int row = HIGH / 2;
  pf_rectangle_t body = {0, row, WIDE, HIGH - row};
  const pf_mask_t mask = mask_of_rectangles(&body, 1);
  for (int backend = PF_BACKEND_FILTER; backend <= PF_BACKEND_WINDOW; ++backend)
    for (int start = 0; start < 2; ++start) {
      pf_target_t target;
      pf_pose_t pose;
      config.backend = backend;
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_target(sim, PF_TARGET_POINTS, &target));
      for (int masked = 0; masked < 2; ++masked) {
        open_slam();
        if (start == 1) TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_target(slam, &target));
        if (masked) TEST_ASSERT_EQUAL_INT(PF_OK, pf_set_mask(slam, &mask));
        const int count = below(row, &pose);
        TEST_ASSERT_TRUE(masked ? count == 0 : count > 0);
      }
    }
}

/* A mask may come while the map is there: its features below are looked for no more, and are not lost by that. */
static void test_a_mask_should_work_from_the_next_image_on(void) {
  const int row = HIGH / 2;
  pf_rectangle_t body = {0, row, WIDE, HIGH - row};
  const pf_mask_t mask = mask_of_rectangles(&body, 1);
  pf_image_t image;
  pf_report_t before, after;
  pf_pose_t pose;
  open_slam();
  TEST_ASSERT_TRUE(below(row, &pose) > 0);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(slam, &before));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_set_mask(slam, &mask));
  for (int k = 0; k < 10 && pf_sim_next(sim, &image, NULL); ++k) {
    pf_match_t matches[300];
    size_t n = 0;
    TEST_ASSERT_TRUE(pf_push_frame(slam, &image) >= PF_OK);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_matches(slam, matches, 300, &n));
    for (size_t i = 0; i < n; ++i)
      TEST_ASSERT_TRUE(matches[i].status == PF_MATCH_MISSED || matches[i].measured_px[1] < row);
  }
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(slam, &after));
  TEST_ASSERT_TRUE(after.features >= before.features);
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_what_is_wrong_should_be_refused_and_change_nothing);
  RUN_TEST(test_room_should_be_asked_for_and_be_one_bit_a_cell);
  RUN_TEST(test_a_mask_should_end_with_one_that_is_all_scene_and_with_a_reset);
  RUN_TEST(test_too_little_that_is_left_should_be_noted);
  RUN_TEST(test_what_is_masked_should_not_be_measured);
  RUN_TEST(test_a_mask_should_work_from_the_next_image_on);
  return UNITY_END();
}
