/* Templates with masks: what the config allows, what they cost, and what pf_get_template says. */
#include <planefold/planefold.h>
#include <string.h>

#include "small_context.h"

static void refuse(const char* name) {
  const char* field = NULL;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_CONFIG, pf_config_check(&config, &field));
  TEST_ASSERT_EQUAL_STRING(name, field);
}

static void test_bad_fields_should_be_refused_by_name(void) {
  for (int32_t side = 8; side <= 33; ++side) {
    config.capacity.template_px = side;
    if (side % 2 == 1 && side >= 9 && side <= 31)
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL));
    else
      refuse("capacity.template_px");
  }
  config.capacity.template_px = 15;
  config.map.masks = 3;
  refuse("map.masks");
  config.map.masks = PF_MASKS_PARTIAL;
  config.map.max_misfit = 0;
  refuse("map.max_misfit");
}

static void test_masks_should_cost_at_most_512_bytes_a_feature_and_nothing_when_off(void) {
  pf_memory_t few, many;
  config.capacity.template_px = 31;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &few));
  TEST_ASSERT_EQUAL_UINT64(need.bytes, few.bytes); /* off: the side does not matter */
  config.capacity.template_px = 15;
  config.map.masks = PF_MASKS_PARTIAL;
  size_t with[2], without[2];
  for (int k = 0; k < 2; ++k) {
    config.capacity.max_features = 100 + 800 * k;
    config.map.masks = PF_MASKS_PARTIAL;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &many));
    with[k] = many.bytes;
    config.map.masks = PF_MASKS_NONE;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &many));
    without[k] = many.bytes;
  }
  TEST_ASSERT_TRUE(with[1] - with[0] - (without[1] - without[0]) <= 512 * 800);
}

static void test_template_should_hold_the_pixels_of_first_sight(void) {
  pf_template_t out, before;
  memset(&out, 7, sizeof out);
  before = out;
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_template(NULL, 1, &out));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_template(slam, 1, NULL));
  TEST_ASSERT_EQUAL_INT(PF_NOTE_NOTHING, pf_get_template(slam, 1, &out));
  TEST_ASSERT_EQUAL_MEMORY(&before, &out, sizeof out);

  config.map.masks = PF_MASKS_PARTIAL;
  pf_memory_t with;
  pf_slam_t* masked;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &with));
  unsigned char* memory = new_block(with.bytes, 99);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, memory, with.bytes, &masked));
  const pf_image_t image = {pixels, WIDTH, HEIGHT, WIDTH, STEP_NS};
  TEST_ASSERT_TRUE(pf_push_frame(masked, &image) >= PF_OK);
  pf_match_t matches[60];
  size_t count;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_matches(masked, matches, 60, &count));
  TEST_ASSERT_TRUE(count > 0);
  for (size_t k = 0; k < count; ++k) {
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_template(masked, matches[k].id, &out));
    TEST_ASSERT_EQUAL_UINT32(matches[k].id, out.feature);
    TEST_ASSERT_EQUAL_INT(15, out.side);
    TEST_ASSERT_EQUAL_INT(0, out.frames);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, matches[k].measured_px[0], out.centre_px[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, matches[k].measured_px[1], out.centre_px[1]);
    const int left = (int)out.centre_px[0] - 7, top = (int)out.centre_px[1] - 7;
    for (int i = 0; i < 225; ++i) {
      TEST_ASSERT_EQUAL_INT(pixels[(top + i / 15) * WIDTH + left + i % 15], out.grey[i]);
      TEST_ASSERT_EQUAL_INT(128, out.mask[i]);
    }
    /* It faces the first camera, and may be anything else. */
    TEST_ASSERT_TRUE(out.sigma_normal_rad > 0.3);
    const double* n = out.normal_W;
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1, n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  }
  free_block(memory);
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_bad_fields_should_be_refused_by_name);
  RUN_TEST(test_masks_should_cost_at_most_512_bytes_a_feature_and_nothing_when_off);
  RUN_TEST(test_template_should_hold_the_pixels_of_first_sight);
  return UNITY_END();
}
