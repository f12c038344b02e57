// Formats of cameras to grey levels, with padding between rows; refusals.
#include <planefold_platform/libcamera.h>
#include <unity.h>

#include <cstring>
#include <vector>

#include "../../platform/libcamera/luma.h"

namespace {

constexpr int32_t kWidth = 6;
constexpr int32_t kHeight = 3;
constexpr size_t kStride = 32;
constexpr uint8_t kPadding = 0xaa;

/// Grey level of a pixel; all differ.
uint8_t level(int32_t x, int32_t y) { return static_cast<uint8_t>(17 + 40 * y + 5 * x); }

/// A plane whose byte at place of every pixel is its level, and the others are something else.
std::vector<uint8_t> plane(size_t pixel_bytes, size_t place) {
  std::vector<uint8_t> in(kStride * kHeight, kPadding);
  for (int32_t y = 0; y < kHeight; ++y) {
    for (int32_t x = 0; x < kWidth; ++x) {
      in[static_cast<size_t>(y) * kStride + static_cast<size_t>(x) * pixel_bytes + place] = level(x, y);
    }
  }
  return in;
}

std::vector<uint8_t> grey_of(uint32_t format, const std::vector<uint8_t>& in) {
  std::vector<uint8_t> out(static_cast<size_t>(kWidth) * kHeight);
  pf::libcamera::to_grey(format, in.data(), kStride, kWidth, kHeight, out.data());
  return out;
}

void expect_levels(const std::vector<uint8_t>& out) {
  for (int32_t y = 0; y < kHeight; ++y) {
    for (int32_t x = 0; x < kWidth; ++x) {
      TEST_ASSERT_EQUAL_UINT8(level(x, y), out[static_cast<size_t>(y * kWidth + x)]);
    }
  }
}

void test_formats_with_a_grey_plane_should_lose_the_padding_of_rows() {
  for (const uint32_t format : {PF_LIBCAMERA_GREY, PF_LIBCAMERA_YUV420, PF_LIBCAMERA_NV12}) {
    expect_levels(grey_of(format, plane(1, 0)));
  }
}

void test_yuyv_should_give_its_luma() { expect_levels(grey_of(PF_LIBCAMERA_YUYV, plane(2, 0))); }

void test_colours_should_be_weighted_in_their_order_in_memory() {
  const uint8_t colours[][4] = {{255, 0, 0, 77}, {0, 255, 0, 149}, {0, 0, 255, 29}, {255, 255, 255, 255}, {0, 0, 0, 0}};
  for (const auto& colour : colours) {  // red, green, blue, and what becomes of them
    std::vector<uint8_t> rgb(kStride * kHeight, kPadding);
    std::vector<uint8_t> bgr(kStride * kHeight, kPadding);
    for (size_t i = 0; i < 3; ++i) {
      bgr[i] = colour[i];      // the first pixel; BGR888 begins with red
      rgb[2 - i] = colour[i];  // RGB888 begins with blue
    }
    TEST_ASSERT_EQUAL_UINT8(colour[3], grey_of(PF_LIBCAMERA_RGB888, rgb)[0]);
    TEST_ASSERT_EQUAL_UINT8(colour[3], grey_of(PF_LIBCAMERA_BGR888, bgr)[0]);
  }
}

void test_colours_should_find_every_pixel_of_padded_rows() {
  const std::vector<uint8_t> out = grey_of(PF_LIBCAMERA_RGB888, plane(3, 1));
  for (int32_t y = 0; y < kHeight; ++y) {
    for (int32_t x = 0; x < kWidth; ++x) {
      const int expected = (77 * kPadding + 150 * level(x, y) + 29 * kPadding + 128) / 256;
      TEST_ASSERT_EQUAL_UINT8(expected, out[static_cast<size_t>(y * kWidth + x)]);
    }
  }
}

void test_open_should_refuse_options_out_of_range() {
  pf_libcamera_options_t options;
  pf_libcamera_options_default(&options);  // no size
  char message[PF_LIBCAMERA_MESSAGE] = "";
  pf_libcamera_t* camera = reinterpret_cast<pf_libcamera_t*>(message);
  TEST_ASSERT_EQUAL_INT(-1, pf_libcamera_open("0", &options, &camera, message));
  TEST_ASSERT_NULL(camera);
  TEST_ASSERT_NOT_NULL(std::strstr(message, "libcamera.h"));
}

void test_open_should_name_a_camera_that_is_not_there() {
  pf_libcamera_options_t options;
  pf_libcamera_options_default(&options);
  options.width = 640;
  options.height = 480;
  char message[PF_LIBCAMERA_MESSAGE] = "";
  pf_libcamera_t* camera = nullptr;
  TEST_ASSERT_EQUAL_INT(-1, pf_libcamera_open("no camera is called so", &options, &camera, message));
  TEST_ASSERT_NULL(camera);
  TEST_ASSERT_NOT_NULL(std::strstr(message, "camera"));
  TEST_ASSERT_NULL(std::strchr(message, '\n'));
}

void test_calls_without_a_camera_should_be_refused() {
  pf_libcamera_frame_t frame;
  char message[PF_LIBCAMERA_MESSAGE] = "";
  TEST_ASSERT_EQUAL_INT(-1, pf_libcamera_start(nullptr, message));
  TEST_ASSERT_EQUAL_INT(-1, pf_libcamera_read(nullptr, 0, &frame, message));
  TEST_ASSERT_EQUAL_INT(-1, pf_libcamera_return(nullptr, message));
  TEST_ASSERT_EQUAL_INT(0, pf_libcamera_stop(nullptr, message));
  pf_libcamera_release(nullptr, &frame);
  pf_libcamera_close(nullptr);
  TEST_ASSERT_NULL(pf_libcamera_format_name(PF_LIBCAMERA_FORMATS));
}

}  // namespace

void setUp() {}
void tearDown() {}

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_formats_with_a_grey_plane_should_lose_the_padding_of_rows);
  RUN_TEST(test_yuyv_should_give_its_luma);
  RUN_TEST(test_colours_should_be_weighted_in_their_order_in_memory);
  RUN_TEST(test_colours_should_find_every_pixel_of_padded_rows);
  RUN_TEST(test_open_should_refuse_options_out_of_range);
  RUN_TEST(test_open_should_name_a_camera_that_is_not_there);
  RUN_TEST(test_calls_without_a_camera_should_be_refused);
  return UNITY_END();
}
