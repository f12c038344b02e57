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
} errors_t;

static void on_error(j_common_ptr info) { longjmp(((errors_t*)info->err)->back, 1); }

/* libjpeg fills up what is missing with grey and only warns; half an image would be tracked. */
static void on_message(j_common_ptr info, int level) {
  const int code = info->err->msg_code;
  if (level < 0 && (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER || code == JWRN_HUFF_BAD_CODE)) {
    on_error(info);
  }
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
