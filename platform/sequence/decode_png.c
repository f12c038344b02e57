#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "decode.h"

/* What libpng's callbacks need; lives outside of the function that setjmp protects. */
typedef struct reader {
  const uint8_t* bytes;
  size_t size, at;
  char* why;
  png_bytep rows[PF_DECODE_MAX_SIDE];
} reader_t;

static void on_error(png_structp png, png_const_charp text) {
  const reader_t* reader = (const reader_t*)png_get_error_ptr(png);
  snprintf(reader->why, PF_DECODE_WHY, "is damaged or cut off (libpng: %.100s)", text);
  png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp text) {
  (void)png;
  (void)text;
}

static void on_read(png_structp png, png_bytep out, size_t count) {
  reader_t* reader = (reader_t*)png_get_io_ptr(png);
  if (count > reader->size - reader->at) {
    png_error(png, "the file ends early");
  }
  memcpy(out, reader->bytes + reader->at, count);
  reader->at += count;
}

/* Numbers of 16 bits in scratch to grey levels. */
static void to_bytes(pf_decoded_t* image, unsigned channels) {
  const size_t count = (size_t)image->width * (size_t)image->height * channels;
  size_t i;
  for (i = 0; i < count; ++i) {
    image->scratch[i] = pf_decode_level(image, 256u * image->scratch[2 * i] + image->scratch[2 * i + 1]);
  }
}

/* Rows of 1 or 3 bytes per pixel in scratch to grey: 0.299 R + 0.587 G + 0.114 B, no gamma (as Rec. 601). */
static void to_grey(pf_decoded_t* image, unsigned channels) {
  const size_t area = (size_t)image->width * (size_t)image->height;
  const uint8_t* in = image->scratch;
  size_t i;
  if (channels == 1) {
    memcpy(image->pixels, in, area);
    return;
  }
  for (i = 0; i < area; ++i, in += 3) {
    image->pixels[i] = (uint8_t)((299u * in[0] + 587u * in[1] + 114u * in[2] + 500u) / 1000u);
  }
}

static int decode(png_structp png, png_infop info, reader_t* reader, pf_decoded_t* image) {
  png_uint_32 y, height, width;
  unsigned channels, depth;
  if (setjmp(png_jmpbuf(png))) {
    return -1;
  }
  png_set_read_fn(png, reader, on_read);
  png_set_user_limits(png, PF_DECODE_MAX_SIDE, PF_DECODE_MAX_SIDE);
  png_read_info(png, info);
  width = png_get_image_width(png, info);
  height = png_get_image_height(png, info);
  image->bits = png_get_bit_depth(png, info) == 16 ? 16 : 8;
  depth = (unsigned)image->bits / 8;
  png_set_expand(png);
  png_set_strip_alpha(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  channels = png_get_channels(png, info);
  if ((channels != 1 && channels != 3) || png_get_rowbytes(png, info) != (size_t)width * channels * depth) {
    png_error(png, "unexpected pixel layout");
  }
  if (pf_decode_reserve(image, width, height, channels * depth, reader->why) != 0) {
    return -1;
  }
  image->channels = (int32_t)channels;
  for (y = 0; y < height; ++y) {
    reader->rows[y] = image->scratch + (size_t)y * width * channels * depth;
  }
  png_read_image(png, reader->rows);
  png_read_end(png, NULL);
  if (depth == 2) {
    to_bytes(image, channels);
  }
  to_grey(image, channels);
  return 0;
}

int pf_decode_png(const uint8_t* bytes, size_t size, pf_decoded_t* image, char why[PF_DECODE_WHY]) {
  int result = -1;
  png_structp png;
  png_infop info;
  reader_t* reader = (reader_t*)malloc(sizeof(*reader));
  snprintf(why, PF_DECODE_WHY, "needs more memory than there is");
  if (reader == NULL) {
    return -1;
  }
  reader->bytes = bytes;
  reader->size = size;
  reader->at = 0;
  reader->why = why;
  png = png_create_read_struct(PNG_LIBPNG_VER_STRING, reader, on_error, on_warning);
  info = png != NULL ? png_create_info_struct(png) : NULL;
  if (info != NULL) {
    result = decode(png, info, reader, image);
  }
  png_destroy_read_struct(&png, &info, NULL);
  free(reader);
  return result;
}
