#include <stdio.h>

#include "decode.h"

/* Next number of the header, after blanks and comments; -1 when there is none. */
static long next_number(const uint8_t* bytes, size_t size, size_t* at) {
  long value = -1;
  while (*at < size && (bytes[*at] <= ' ' || bytes[*at] == '#')) {
    if (bytes[*at] == '#') {
      while (*at < size && bytes[*at] != '\n') {
        ++*at;
      }
    } else {
      ++*at;
    }
  }
  while (*at < size && bytes[*at] >= '0' && bytes[*at] <= '9' && value < 1000000) {
    value = (value < 0 ? 0 : 10 * value) + (bytes[*at] - '0');
    ++*at;
  }
  return value;
}

int pf_decode_pgm(const uint8_t* bytes, size_t size, pf_decoded_t* image, char why[PF_DECODE_WHY]) {
  size_t at = 2;
  const long width = next_number(bytes, size, &at);
  const long height = next_number(bytes, size, &at);
  const long top = next_number(bytes, size, &at);
  size_t depth, area, i;
  if (width < 0 || height < 0 || top < 1 || top > 65535 || at >= size || bytes[at] > ' ') {
    snprintf(why, PF_DECODE_WHY, "has a damaged PGM header (P5, width, height, 1 .. 65535)");
    return -1;
  }
  ++at;
  if (pf_decode_reserve(image, (uint64_t)width, (uint64_t)height, 0, why) != 0) {
    return -1;
  }
  depth = top > 255 ? 2 : 1;
  image->channels = 1;
  image->bits = (int32_t)(8 * depth);
  area = (size_t)width * (size_t)height;
  if (size - at < area * depth) {
    snprintf(why, PF_DECODE_WHY, "ends after %zu of its %zu bytes of pixels", size - at, area * depth);
    return -1;
  }
  for (i = 0; i < area; ++i) {
    long value = depth == 1 ? bytes[at + i] : 256L * bytes[at + 2 * i] + bytes[at + 2 * i + 1];
    if (top == 65535) {
      image->pixels[i] = pf_decode_level(image, (uint32_t)value);
      continue;
    }
    if (value > top) {
      value = top;
    }
    image->pixels[i] = (uint8_t)(top == 255 ? value : (255 * value + top / 2) / top);
  }
  return 0;
}
