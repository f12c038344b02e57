/* What this room knows of the pixel formats of cameras. */
#ifndef PLANEFOLD_PLATFORM_V4L2_FORMATS_H
#define PLANEFOLD_PLATFORM_V4L2_FORMATS_H

#include <stddef.h>
#include <stdint.h>

typedef enum pf_v4l2_layout {
  PF_LAYOUT_PLANE,  /* 8-bit grey levels in front, colour behind or nowhere */
  PF_LAYOUT_PAIRS,  /* every second byte is a grey level */
  PF_LAYOUT_SAMPLE, /* 16 bits a pixel, little endian */
  PF_LAYOUT_MIPI10, /* four pixels in five bytes: their upper eight bits, then what is below of all four */
  PF_LAYOUT_JPEG
} pf_v4l2_layout_t;

enum { PF_FOURCCS = 3 };

typedef struct pf_v4l2_format_row {
  const char* name;
  uint32_t fourccs[PF_FOURCCS]; /* the kernel's; 0 where there are fewer */
  pf_v4l2_layout_t layout;
  uint32_t
      detail; /* pairs: where the first grey level lies, 0 or 1. Samples: their bits, 0 where pictures must show it */
} pf_v4l2_format_row_t;

/* Of a pf_v4l2_format_t; null for what is none. */
const pf_v4l2_format_row_t* pf_v4l2_format_row(uint32_t format);

/* Format number rank in order of cost, from 0 on; 0 (any) behind the last one. */
uint32_t pf_v4l2_format_by_cost(uint32_t rank);

/* The pf_v4l2_format_t of a fourcc; 0: not known. */
uint32_t pf_v4l2_format_of(uint32_t fourcc);

/* Bytes of a row that has no padding. */
uint32_t pf_v4l2_row_bytes(uint32_t format, int32_t width);

/* Adds a name to a list ("GREY, NV12"), if it has the room and not yet the name. */
void pf_v4l2_add_name(char* list, size_t size, const char* name);
void pf_v4l2_add_fourcc(char* list, size_t size, uint32_t fourcc);

/* "GREY, NV12, .." of those whose bit 1 << f is set. */
void pf_v4l2_name_formats(uint32_t formats, char* list, size_t size);

#endif
