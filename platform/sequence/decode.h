/* Image files in memory to grey levels. C, because libpng and libjpeg report errors by longjmp. */
#ifndef PLANEFOLD_PLATFORM_SEQUENCE_DECODE_H
#define PLANEFOLD_PLATFORM_SEQUENCE_DECODE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PF_DECODE_MAX_SIDE 4096 /* [px] as pf_camera_t */
#define PF_DECODE_WHY 160

/* Buffers that are kept from image to image. Begin with zeros, end with pf_decode_free. */
typedef struct pf_decoded {
  uint8_t* pixels; /* width * height grey levels, no padding */
  uint8_t* scratch;
  size_t pixels_capacity, scratch_capacity;
  int32_t width, height;
  int32_t channels, bits; /* as the file has them: 1 grey or 3 colour; 8 or 16 for each */
  int32_t brightest;      /* where 65535 is white by the file: the largest number; else 0 */
  int32_t orientation;    /* of a JPEG: by EXIF, 1 (as stored) .. 8; 0 where it says nothing */
  int32_t black,
      white; /* from the caller, where 65535 is white by the file: these become 0 and 255; white 0: as the file says */
  uint32_t* histogram; /* from the caller: 65536 counts, to which such numbers are added; NULL: none is wanted */
} pf_decoded_t;

/* By the first bytes: PNG, JPEG or binary PGM. 0, or -1 with the reason in why; the buffers stay valid either way. */
int pf_decode_image(const uint8_t* bytes, size_t size, pf_decoded_t* image, char why[PF_DECODE_WHY]);
void pf_decode_free(pf_decoded_t* image);

/* The parts. */
int pf_decode_png(const uint8_t* bytes, size_t size, pf_decoded_t* image, char why[PF_DECODE_WHY]);
int pf_decode_jpeg(const uint8_t* bytes, size_t size, pf_decoded_t* image, char why[PF_DECODE_WHY]);
int pf_decode_pgm(const uint8_t* bytes, size_t size, pf_decoded_t* image, char why[PF_DECODE_WHY]);

/* The grey level of a number of 16 bits, by black and white; it is counted. */
uint8_t pf_decode_level(pf_decoded_t* image, uint32_t value);

/* Sets the size after checking it, and makes room; scratch_channels is 0 .. 6 bytes of scratch per pixel. */
int pf_decode_reserve(pf_decoded_t* image, uint64_t width, uint64_t height, unsigned scratch_channels,
                      char why[PF_DECODE_WHY]);

#ifdef __cplusplus
}
#endif

#endif
