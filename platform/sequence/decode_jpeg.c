/* jpeglib.h needs stdio.h before it. */
/* clang-format off */
#include <setjmp.h>
#include <stdio.h>
#include <string.h>

#include <jpeglib.h>
#include <jerror.h>
/* clang-format on */

#include "decode.h"

typedef struct errors {
  struct jpeg_error_mgr manager; /* first: libjpeg hands back this address */
  jmp_buf back;
  const uint8_t* bytes;
  size_t size;
  char* why;
} errors_t;

static void on_error(j_common_ptr info) {
  errors_t* errors = (errors_t*)info->err;
  char text[JMSG_LENGTH_MAX];
  info->err->format_message(info, text);
  snprintf(errors->why, PF_DECODE_WHY, "is damaged or cut off (libjpeg: %.100s)", text);
  longjmp(errors->back, 1);
}

/* Bytes of one value right before the end of the image: some cameras fill up to a whole number of words so. */
static int is_padding(const uint8_t* bytes, size_t size, int count) {
  size_t end = size, i;
  while (end >= 2 && !(bytes[end - 2] == 0xff && bytes[end - 1] == JPEG_EOI)) {
    --end;
  }
  if (count < 1 || end < 2 || (size_t)count > end - 2) {
    return 0;
  }
  for (i = end - 2 - (size_t)count; i < end - 3; ++i) {
    if (bytes[i] != bytes[end - 3]) {
      return 0;
    }
  }
  return 1;
}

/* libjpeg only warns of data that cannot be right, fills up what is missing with grey, and goes on: half an image would be tracked. So
 * what it warns of is refused, but for padding, and for a field that has no part in the pixels. */
static void on_message(j_common_ptr info, int level) {
  const struct jpeg_error_mgr* error = info->err;
  errors_t* errors = (errors_t*)info->err;
  if (level >= 0 || error->msg_code == JWRN_JFIF_MAJOR) {
    return;
  }
  if (error->msg_code == JWRN_EXTRANEOUS_DATA && error->msg_parm.i[1] == JPEG_EOI &&
      is_padding(errors->bytes, errors->size, error->msg_parm.i[0])) {
    return;
  }
  on_error(info);
}

static unsigned number(const uint8_t* at, int count, int big) {
  unsigned value = 0;
  int i;
  for (i = 0; i < count; ++i) {
    value = 256 * value + at[big ? i : count - 1 - i];
  }
  return value;
}

/* Orientation (tag 0x0112) in the first directory of a segment "Exif\0\0", TIFF header, directories. 0: there is none. */
static int exif_orientation(const uint8_t* data, size_t size) {
  size_t at, entries, i;
  int big;
  if (size < 14 || memcmp(data, "Exif\0", 6) != 0) {
    return 0;
  }
  data += 6;
  size -= 6;
  big = data[0] == 'M';
  at = number(data + 4, 4, big);
  if (at > size || size - at < 2) {
    return 0;
  }
  entries = number(data + at, 2, big);
  for (i = 0, at += 2; i < entries && size - at >= 12; ++i, at += 12) {
    if (number(data + at, 2, big) == 0x0112) {
      const unsigned value = number(data + at + 8, 2, big);
      return value >= 1 && value <= 8 ? (int)value : 0;
    }
  }
  return 0;
}

static int decode(struct jpeg_decompress_struct* info, errors_t* errors, const uint8_t* bytes, size_t size,
                  pf_decoded_t* image) {
  jpeg_saved_marker_ptr marker;
  if (setjmp(errors->back)) {
    return -1;
  }
  jpeg_create_decompress(info);
  jpeg_mem_src(info, bytes, (unsigned long)size);
  jpeg_save_markers(info, JPEG_APP0 + 1, 0xffff);
  jpeg_read_header(info, TRUE);
  for (marker = info->marker_list; marker != NULL && image->orientation == 0; marker = marker->next) {
    image->orientation = exif_orientation(marker->data, marker->data_length);
  }
  if (info->num_components == 4) {
    snprintf(errors->why, PF_DECODE_WHY, "is in CMYK, as for printing; convert it to grey or RGB");
    return -1;
  }
  info->out_color_space = JCS_GRAYSCALE;
  if (pf_decode_reserve(image, info->image_width, info->image_height, 0, errors->why) != 0) {
    return -1;
  }
  image->channels = info->num_components == 1 ? 1 : 3;
  image->bits = 8;
  jpeg_start_decompress(info);
  while (info->output_scanline < info->output_height) {
    JSAMPROW row = image->pixels + (size_t)info->output_scanline * (size_t)image->width;
    jpeg_read_scanlines(info, &row, 1);
  }
  jpeg_finish_decompress(info);
  return 0;
}

int pf_decode_jpeg(const uint8_t* bytes, size_t size, pf_decoded_t* image, char why[PF_DECODE_WHY]) {
  struct jpeg_decompress_struct info;
  errors_t errors;
  int result;
  memset(&info, 0, sizeof(info));
  info.err = jpeg_std_error(&errors.manager);
  errors.manager.error_exit = on_error;
  errors.manager.emit_message = on_message;
  errors.bytes = bytes;
  errors.size = size;
  errors.why = why;
  result = decode(&info, &errors, bytes, size, image);
  jpeg_destroy_decompress(&info);
  return result;
}
