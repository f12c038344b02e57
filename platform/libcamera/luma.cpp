#include "luma.h"

#include <cstring>

namespace pf::libcamera {

size_t row_bytes(uint32_t format, int32_t width) {
  const auto pixels = static_cast<size_t>(width);
  switch (format) {
    case PF_LIBCAMERA_YUYV:
      return 2 * pixels;
    case PF_LIBCAMERA_RGB888:
    case PF_LIBCAMERA_BGR888:
      return 3 * pixels;
    default:
      return pixels;
  }
}

bool has_grey_plane(uint32_t format) {
  return format == PF_LIBCAMERA_GREY || format == PF_LIBCAMERA_YUV420 || format == PF_LIBCAMERA_NV12;
}

void to_grey(uint32_t format, const uint8_t* in, size_t stride, int32_t width, int32_t height, uint8_t* out) {
  const auto count = static_cast<size_t>(width);
  const size_t red = format == PF_LIBCAMERA_RGB888 ? 2 : 0;
  for (int32_t y = 0; y < height; ++y) {
    const uint8_t* row = in + static_cast<size_t>(y) * stride;
    uint8_t* grey = out + static_cast<size_t>(y) * count;
    if (has_grey_plane(format)) {
      std::memcpy(grey, row, count);
    } else if (format == PF_LIBCAMERA_YUYV) {
      for (size_t x = 0; x < count; ++x) {
        grey[x] = row[2 * x];
      }
    } else {
      for (size_t x = 0; x < count; ++x) {
        const uint8_t* pixel = row + 3 * x;
        grey[x] = static_cast<uint8_t>((77u * pixel[red] + 150u * pixel[1] + 29u * pixel[2 - red] + 128u) >> 8);
      }
    }
  }
}

}  // namespace pf::libcamera
