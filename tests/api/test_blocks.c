/* The caller's block: what is refused, and that neither its place nor what it held before has any influence. */
#include <math.h>
#include <planefold/planefold.h>
#include <stddef.h>
#include <string.h>

#include "small_context.h"

static void test_a_block_should_be_refused_when_it_is_too_small_or_misaligned(void) {
  pf_slam_t* other = slam;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_MEMORY, pf_create(&config, block, need.bytes - 1, &other));
  TEST_ASSERT_NULL(other);
  other = slam;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_MEMORY, pf_create(&config, block, 0, &other));
  TEST_ASSERT_NULL(other);
  for (size_t shift = 1; shift < need.alignment; shift *= 2) {
    other = slam;
    TEST_ASSERT_EQUAL_INT(PF_ERROR_ALIGNMENT, pf_create(&config, block + shift, need.bytes, &other));
    TEST_ASSERT_NULL(other);
  }
  config.measurement.sigma_px = -1;
  other = slam;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_CONFIG, pf_create(&config, block, need.bytes, &other));
  TEST_ASSERT_NULL(other);
}

static void test_a_context_should_be_refused_when_its_block_was_moved_or_overwritten(void) {
  unsigned char* elsewhere = new_block(need.bytes, 0);
  const ptrdiff_t at = (const unsigned char*)slam - block;
  pf_pose_t pose;
  run(slam, 3);
  copy_block(elsewhere, block, need.bytes);
  pf_slam_t* moved = (pf_slam_t*)(void*)(elsewhere + at);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_CONTEXT, pf_get_pose(moved, &pose));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_CONTEXT, pf_reset(moved));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_CONTEXT, push(moved, 3));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &pose));
  memset(elsewhere, 0x5a, need.bytes);
  TEST_ASSERT_EQUAL_INT(PF_ERROR_CONTEXT, pf_get_pose(moved, &pose));
  free_block(elsewhere);
}

static void test_reset_should_be_the_same_as_a_fresh_context(void) {
  run(slam, 20);
  view_t* fresh = view_of(slam);
  for (int k = 20; k < 40; ++k) push(slam, k);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(slam));
  pf_pose_t pose;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_STATE, pf_get_pose(slam, &pose));
  run(slam, 20); /* the times begin again too */
  require_same(fresh, view_of(slam));
}

static void test_result_should_be_the_same_when_the_block_held_garbage_and_lies_elsewhere(void) {
  unsigned char* elsewhere = new_block(need.bytes + 4096, 0xaa);
  pf_slam_t* other;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, elsewhere + 64, need.bytes, &other));
  run(slam, 30);
  run(other, 30);
  require_same(view_of(slam), view_of(other));
  free_block(elsewhere);
}

static void test_frames_should_give_the_same_result_when_the_block_held_garbage(void) {
  unsigned char* elsewhere = new_block(need.bytes + 4096, 0xaa);
  pf_slam_t* other;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, elsewhere + 192, need.bytes, &other));
  /* A smooth picture that moves by a pixel a frame. */
  for (int k = 0; k < 25; ++k) {
    for (int y = 0; y < HEIGHT; ++y)
      for (int x = 0; x < WIDTH; ++x) {
        const double u = x + k, v = y + 0.3 * k;
        pixels[y * WIDTH + x] =
            (uint8_t)(128 + 50 * sin(0.31 * u + 0.17 * v) + 50 * sin(0.23 * v - 0.11 * u) * cos(0.05 * u));
      }
    const pf_image_t image = {pixels, WIDTH, HEIGHT, WIDTH, STEP_NS * (k + 1)};
    const pf_status_t status = pf_push_frame(slam, &image);
    TEST_ASSERT_TRUE(status >= PF_OK);
    TEST_ASSERT_EQUAL_INT(status, pf_push_frame(other, &image));
  }
  require_same(view_of(slam), view_of(other));
  free_block(elsewhere);
}

static void test_getters_should_tell_how_many_there_are_when_the_array_is_short(void) {
  pf_feature_t features[POINTS];
  pf_match_t tracks[4];
  size_t count = 0;
  run(slam, 3);
  TEST_ASSERT_EQUAL_INT(PF_NOTE_TRUNCATED, pf_get_features(slam, features, 4, &count));
  TEST_ASSERT_EQUAL_size_t(POINTS, count);
  TEST_ASSERT_EQUAL_INT(PF_NOTE_TRUNCATED, pf_get_features(slam, NULL, 0, &count));
  TEST_ASSERT_EQUAL_size_t(POINTS, count);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_features(slam, features, POINTS, &count));
  TEST_ASSERT_EQUAL_INT(PF_NOTE_TRUNCATED, pf_get_matches(slam, tracks, 4, &count));
  TEST_ASSERT_EQUAL_size_t(POINTS, count);
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_a_block_should_be_refused_when_it_is_too_small_or_misaligned);
  RUN_TEST(test_a_context_should_be_refused_when_its_block_was_moved_or_overwritten);
  RUN_TEST(test_reset_should_be_the_same_as_a_fresh_context);
  RUN_TEST(test_result_should_be_the_same_when_the_block_held_garbage_and_lies_elsewhere);
  RUN_TEST(test_frames_should_give_the_same_result_when_the_block_held_garbage);
  RUN_TEST(test_getters_should_tell_how_many_there_are_when_the_array_is_short);
  return UNITY_END();
}
