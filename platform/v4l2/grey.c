#include "grey.h"

#include <string.h>

void pf_grey_from_grey(const uint8_t* in, size_t stride, int32_t width, int32_t height, uint8_t* out) {
  for (int32_t y = 0; y < height; ++y) {
    memcpy(out + (size_t)y * (size_t)width, in + (size_t)y * stride, (size_t)width);
  }
}

void pf_grey_from_pairs(const uint8_t* in, size_t stride, int32_t width, int32_t height, uint32_t first, uint8_t* out) {
  for (int32_t y = 0; y < height; ++y) {
    const uint8_t* row = in + (size_t)y * stride + first;
    uint8_t* grey = out + (size_t)y * (size_t)width;
    for (int32_t x = 0; x < width; ++x) {
      grey[x] = row[2 * (size_t)x];
    }
  }
}

static uint32_t sample(const uint8_t* row, int32_t x) {
  return (uint32_t)row[2 * (size_t)x] | (uint32_t)row[2 * (size_t)x + 1] << 8;
}

void pf_grey_from_samples(const uint8_t* in, size_t stride, int32_t width, int32_t height, uint32_t bits,
                          uint8_t* out) {
  const uint32_t shift = bits - 8;
  for (int32_t y = 0; y < height; ++y) {
    const uint8_t* row = in + (size_t)y * stride;
    uint8_t* grey = out + (size_t)y * (size_t)width;
    for (int32_t x = 0; x < width; ++x) {
      const uint32_t level = sample(row, x) >> shift;
      grey[x] = (uint8_t)(level < 255 ? level : 255);
    }
  }
}

void pf_grey_from_mipi10(const uint8_t* in, size_t stride, int32_t width, int32_t height, uint8_t* out) {
  for (int32_t y = 0; y < height; ++y) {
    const uint8_t* row = in + (size_t)y * stride;
    uint8_t* grey = out + (size_t)y * (size_t)width;
    for (int32_t x = 0; x < width; ++x) {
      grey[x] = row[x / 4 * 5 + x % 4];
    }
  }
}

uint32_t pf_bits_of_samples(const uint8_t* in, size_t stride, int32_t width, int32_t height) {
  uint32_t used = 0; /* bits that are set in some sample */
  for (int32_t y = 0; y < height; ++y) {
    const uint8_t* row = in + (size_t)y * stride;
    for (int32_t x = 0; x < width; ++x) {
      used |= sample(row, x);
    }
  }
  for (uint32_t bits = 10; bits < 16; bits += 2) {
    const uint32_t empty_if_shifted = (1u << (16 - bits)) - 1; /* samples of so many bits in the upper part of 16 */
    if (used != 0 && used < 1u << bits && (used & empty_if_shifted) != 0) {
      return bits;
    }
  }
  return used == 0 ? 10 : 16;
}
