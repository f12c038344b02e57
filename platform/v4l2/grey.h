/* Camera formats to grey levels. Rows of the input are stride bytes apart, rows of the output width bytes. */
#ifndef PLANEFOLD_PLATFORM_V4L2_GREY_H
#define PLANEFOLD_PLATFORM_V4L2_GREY_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

void pf_grey_from_grey(const uint8_t* in, size_t stride, int32_t width, int32_t height, uint8_t* out);
/* Every second byte, from byte first (0 or 1) on. */
void pf_grey_from_pairs(const uint8_t* in, size_t stride, int32_t width, int32_t height, uint32_t first, uint8_t* out);
/* The upper 8 of bits (8 .. 16) bits, from samples of 16, little endian; what has more bits is white. */
void pf_grey_from_samples(const uint8_t* in, size_t stride, int32_t width, int32_t height, uint32_t bits, uint8_t* out);
/* The first four of every five bytes. */
void pf_grey_from_mipi10(const uint8_t* in, size_t stride, int32_t width, int32_t height, uint8_t* out);

/* How many bits samples of 16 have at least: 10, 12, 14 or 16. Those whose lower bits are all 0 are taken to fill all 16. */
uint32_t pf_bits_of_samples(const uint8_t* in, size_t stride, int32_t width, int32_t height);

/* A JPEG picture, also one without Huffman tables as cameras send it. 0, or -1 where it is damaged, of another size, or where
 * this build has no libjpeg. */
int pf_grey_from_jpeg(const uint8_t* in, size_t bytes, int32_t width, int32_t height, uint8_t* out);

#ifdef __cplusplus
}
#endif

#endif
