/* Camera formats to grey levels. Rows of the input are stride bytes apart, rows of the output width bytes. */
#ifndef PLANEFOLD_PLATFORM_V4L2_GREY_H
#define PLANEFOLD_PLATFORM_V4L2_GREY_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

void pf_grey_from_grey(const uint8_t* in, size_t stride, int32_t width, int32_t height, uint8_t* out);
void pf_grey_from_yuyv(const uint8_t* in, size_t stride, int32_t width, int32_t height, uint8_t* out);
/* The upper 8 of 16 bits, little endian. */
void pf_grey_from_y16(const uint8_t* in, size_t stride, int32_t width, int32_t height, uint8_t* out);

/* A JPEG picture, also one without Huffman tables as cameras send it. 0, or -1 where it is damaged, of another size, or where
 * this build has no libjpeg. */
int pf_grey_from_jpeg(const uint8_t* in, size_t bytes, int32_t width, int32_t height, uint8_t* out);

#ifdef __cplusplus
}
#endif

#endif
