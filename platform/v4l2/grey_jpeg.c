/* jpeglib.h needs stdio.h before it. */
/* clang-format off */
#include <setjmp.h>
#include <stdio.h>
#include <string.h>
/* clang-format on */

#include "grey.h"

#ifdef PLANEFOLD_HAVE_JPEG

/* clang-format off */
#include <jpeglib.h>
#include <jerror.h>
/* clang-format on */

typedef struct errors {
  struct jpeg_error_mgr manager; /* first: libjpeg hands back this address */
  jmp_buf back;
  const uint8_t* bytes;
  size_t size;
} errors_t;

static void on_error(j_common_ptr info) { longjmp(((errors_t*)info->err)->back, 1); }

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

static int decode(struct jpeg_decompress_struct* info, errors_t* errors, const uint8_t* in, size_t bytes, int32_t width,
                  int32_t height, uint8_t* out) {
  if (setjmp(errors->back)) {
    return -1;
  }
  jpeg_create_decompress(info);
  jpeg_mem_src(info, in, (unsigned long)bytes);
  jpeg_read_header(info, TRUE);
  if (info->image_width != (JDIMENSION)width || info->image_height != (JDIMENSION)height) {
    return -1;
  }
  info->out_color_space = JCS_GRAYSCALE;
  info->dct_method = JDCT_ISLOW;
  jpeg_start_decompress(info);
  while (info->output_scanline < info->output_height) {
    JSAMPROW row = out + (size_t)info->output_scanline * (size_t)width;
    jpeg_read_scanlines(info, &row, 1);
  }
  jpeg_finish_decompress(info);
  return 0;
}

int pf_grey_from_jpeg(const uint8_t* in, size_t bytes, int32_t width, int32_t height, uint8_t* out) {
  struct jpeg_decompress_struct info;
  errors_t errors;
  int result;
  if (bytes < 4) {
    return -1;
  }
  memset(&info, 0, sizeof(info));
  info.err = jpeg_std_error(&errors.manager);
  errors.manager.error_exit = on_error;
  errors.manager.emit_message = on_message;
  errors.bytes = in;
  errors.size = bytes;
  result = decode(&info, &errors, in, bytes, width, height, out);
  jpeg_destroy_decompress(&info);
  return result;
}

#else

int pf_grey_from_jpeg(const uint8_t* in, size_t bytes, int32_t width, int32_t height, uint8_t* out) {
  (void)in, (void)bytes, (void)width, (void)height, (void)out;
  return -1;
}

#endif
