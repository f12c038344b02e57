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
  char* why;
} errors_t;

static void on_error(j_common_ptr info) {
  errors_t* errors = (errors_t*)info->err;
  char text[JMSG_LENGTH_MAX];
  info->err->format_message(info, text);
  snprintf(errors->why, PF_DECODE_WHY, "is damaged or cut off (libjpeg: %.100s)", text);
  longjmp(errors->back, 1);
}

/* libjpeg fills up what is missing with grey and only warns; half an image would be tracked. */
static void on_message(j_common_ptr info, int level) {
  const int code = info->err->msg_code;
  if (level < 0 && (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER || code == JWRN_HUFF_BAD_CODE)) {
    on_error(info);
  }
}

static int decode(struct jpeg_decompress_struct* info, errors_t* errors, const uint8_t* bytes, size_t size,
                  pf_decoded_t* image) {
  if (setjmp(errors->back)) {
    return -1;
  }
  jpeg_create_decompress(info);
  jpeg_mem_src(info, bytes, (unsigned long)size);
  jpeg_read_header(info, TRUE);
  info->out_color_space = JCS_GRAYSCALE;
  if (pf_decode_reserve(image, info->image_width, info->image_height, 0, errors->why) != 0) {
    return -1;
  }
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
  errors.why = why;
  result = decode(&info, &errors, bytes, size, image);
  jpeg_destroy_decompress(&info);
  return result;
}
