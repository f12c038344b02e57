#include "decode.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int make_room(uint8_t** buffer, size_t* capacity, size_t bytes) {
  uint8_t* grown;
  if (bytes <= *capacity) {
    return 0;
  }
  grown = (uint8_t*)realloc(*buffer, bytes);
  if (grown == NULL) {
    return -1;
  }
  *buffer = grown;
  *capacity = bytes;
  return 0;
}

int pf_decode_reserve(pf_decoded_t* image, uint64_t width, uint64_t height, unsigned scratch_channels,
                      char why[PF_DECODE_WHY]) {
  size_t area;
  if (width == 0 || height == 0 || width > PF_DECODE_MAX_SIDE || height > PF_DECODE_MAX_SIDE) {
    snprintf(why, PF_DECODE_WHY, "says that it is %llu x %llu pixels, and 1 x 1 to %d x %d are possible",
             (unsigned long long)width, (unsigned long long)height, PF_DECODE_MAX_SIDE, PF_DECODE_MAX_SIDE);
    return -1;
  }
  area = (size_t)width * (size_t)height;
  if (make_room(&image->pixels, &image->pixels_capacity, area) != 0 ||
      make_room(&image->scratch, &image->scratch_capacity, area * scratch_channels) != 0) {
    snprintf(why, PF_DECODE_WHY, "needs more memory than there is");
    return -1;
  }
  image->width = (int32_t)width;
  image->height = (int32_t)height;
  return 0;
}

uint8_t pf_decode_level(pf_decoded_t* image, uint32_t value) {
  const int32_t number = (int32_t)value;
  if (number > image->brightest) {
    image->brightest = number;
  }
  if (image->histogram != NULL) {
    ++image->histogram[value];
  }
  if (image->white == 0) {
    return (uint8_t)((value * 255u + 32895u) >> 16); /* as png_set_scale_16 rounds */
  }
  if (number <= image->black) {
    return 0;
  }
  if (number >= image->white) {
    return 255;
  }
  return (uint8_t)((255 * (number - image->black) + (image->white - image->black) / 2) / (image->white - image->black));
}

void pf_decode_free(pf_decoded_t* image) {
  free(image->pixels);
  free(image->scratch);
  memset(image, 0, sizeof(*image));
}

int pf_decode_image(const uint8_t* bytes, size_t size, pf_decoded_t* image, char why[PF_DECODE_WHY]) {
  static const uint8_t png[8] = {0x89, 'P', 'N', 'G', 0x0d, 0x0a, 0x1a, 0x0a};
  image->brightest = image->orientation = 0;
  if (size >= 8 && memcmp(bytes, png, 8) == 0) {
    return pf_decode_png(bytes, size, image, why);
  }
  if (size >= 3 && bytes[0] == 0xff && bytes[1] == 0xd8 && bytes[2] == 0xff) {
    return pf_decode_jpeg(bytes, size, image, why);
  }
  if (size >= 2 && bytes[0] == 'P' && bytes[1] == '5') {
    return pf_decode_pgm(bytes, size, image, why);
  }
  snprintf(why, PF_DECODE_WHY, "is neither PNG, JPEG nor binary PGM (P5) by its first bytes");
  return -1;
}
