#include "grey.h"

#include <string.h>

void pf_grey_from_grey(const uint8_t* in, size_t stride, int32_t width, int32_t height, uint8_t* out) {
  for (int32_t y = 0; y < height; ++y) {
    memcpy(out + (size_t)y * (size_t)width, in + (size_t)y * stride, (size_t)width);
  }
}

/* Every second byte, beginning at one of two. */
static void every_second(const uint8_t* in, size_t stride, int32_t width, int32_t height, uint8_t* out) {
  for (int32_t y = 0; y < height; ++y) {
    const uint8_t* row = in + (size_t)y * stride;
    uint8_t* grey = out + (size_t)y * (size_t)width;
    for (int32_t x = 0; x < width; ++x) {
      grey[x] = row[2 * (size_t)x];
    }
  }
}

void pf_grey_from_yuyv(const uint8_t* in, size_t stride, int32_t width, int32_t height, uint8_t* out) {
  every_second(in, stride, width, height, out);
}

void pf_grey_from_y16(const uint8_t* in, size_t stride, int32_t width, int32_t height, uint8_t* out) {
  every_second(in + 1, stride, width, height, out);
}
