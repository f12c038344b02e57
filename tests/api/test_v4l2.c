/* Formats of cameras to grey levels, with padding between rows. */
#include <planefold_platform/v4l2.h>
#include <string.h>
#include <unity.h>

#include "../../platform/v4l2/grey.h"

enum { kWidth = 6, kHeight = 3, kStride = 16 };

void setUp(void) {}
void tearDown(void) {}

/* Grey level of a pixel; all differ. */
static uint8_t level(int x, int y) { return (uint8_t)(17 + 40 * y + 5 * x); }

static void expect_levels(const uint8_t* out) {
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      TEST_ASSERT_EQUAL_UINT8(level(x, y), out[y * kWidth + x]);
    }
  }
}

static void test_grey_should_lose_the_padding_of_rows(void) {
  uint8_t in[kStride * kHeight];
  uint8_t out[kWidth * kHeight];
  memset(in, 0xaa, sizeof(in));
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      in[y * kStride + x] = level(x, y);
    }
  }
  pf_grey_from_grey(in, kStride, kWidth, kHeight, out);
  expect_levels(out);
}

static void test_yuyv_should_give_its_luma(void) {
  uint8_t in[kStride * kHeight];
  uint8_t out[kWidth * kHeight];
  memset(in, 0xaa, sizeof(in));
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      in[y * kStride + 2 * x] = level(x, y);
    }
  }
  pf_grey_from_pairs(in, kStride, kWidth, kHeight, 0, out);
  expect_levels(out);
}

static void test_y16_should_give_its_upper_bytes(void) {
  uint8_t in[kStride * kHeight];
  uint8_t out[kWidth * kHeight];
  memset(in, 0xaa, sizeof(in));
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      in[y * kStride + 2 * x + 1] = level(x, y);
    }
  }
  pf_grey_from_samples(in, kStride, kWidth, kHeight, 16, out);
  expect_levels(out);
}

static void test_jpeg_should_be_refused_when_it_is_damaged(void) {
  const uint8_t cut_off[] = {0xff, 0xd8, 0xff, 0xe0, 0x00, 0x10, 'J', 'F', 'I', 'F'};
  uint8_t out[kWidth * kHeight];
  TEST_ASSERT_EQUAL_INT(-1, pf_grey_from_jpeg(cut_off, sizeof(cut_off), kWidth, kHeight, out));
  TEST_ASSERT_EQUAL_INT(-1, pf_grey_from_jpeg(cut_off, 2, kWidth, kHeight, out));
}

static void test_open_should_refuse_what_is_no_camera(void) {
  char message[PF_V4L2_MESSAGE] = "";
  pf_v4l2_options_t options;
  pf_v4l2_t* camera = (pf_v4l2_t*)message;
  pf_v4l2_options_default(&options);
  options.width = 640;
  options.height = 480;
  TEST_ASSERT_EQUAL_INT(-1, pf_v4l2_open("/dev/null", &options, &camera, message));
  TEST_ASSERT_NULL(camera);
  TEST_ASSERT_NOT_NULL(strstr(message, "/dev/null"));
  options.buffers = 1;
  TEST_ASSERT_EQUAL_INT(-1, pf_v4l2_open("/dev/null", &options, &camera, message));
  TEST_ASSERT_NOT_NULL(strstr(message, "range"));
}

static void test_names_of_formats_should_be_complete(void) {
  for (uint32_t format = 0; format < PF_V4L2_FORMATS; ++format) {
    TEST_ASSERT_NOT_NULL(pf_v4l2_format_name(format));
  }
  TEST_ASSERT_NULL(pf_v4l2_format_name(PF_V4L2_FORMATS));
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_grey_should_lose_the_padding_of_rows);
  RUN_TEST(test_yuyv_should_give_its_luma);
  RUN_TEST(test_y16_should_give_its_upper_bytes);
  RUN_TEST(test_jpeg_should_be_refused_when_it_is_damaged);
  RUN_TEST(test_open_should_refuse_what_is_no_camera);
  RUN_TEST(test_names_of_formats_should_be_complete);
  return UNITY_END();
}
