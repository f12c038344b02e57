#include "formats.h"

#include <linux/videodev2.h>
#include <planefold_platform/v4l2.h>
#include <stdio.h>
#include <string.h>

/* Some of these are newer than the headers of some systems. */
#define Y14 v4l2_fourcc('Y', '1', '4', ' ')
#define Y10P v4l2_fourcc('Y', '1', '0', 'P')

static const pf_v4l2_format_row_t kRows[PF_V4L2_FORMATS] = {
    [PF_V4L2_ANY] = {"any", {0}, PF_LAYOUT_PLANE, 0},
    [PF_V4L2_GREY] = {"GREY", {V4L2_PIX_FMT_GREY}, PF_LAYOUT_PLANE, 0},
    [PF_V4L2_NV12] = {"NV12", {V4L2_PIX_FMT_NV12, V4L2_PIX_FMT_NV12M}, PF_LAYOUT_PLANE, 0},
    [PF_V4L2_NV21] = {"NV21", {V4L2_PIX_FMT_NV21, V4L2_PIX_FMT_NV21M}, PF_LAYOUT_PLANE, 0},
    [PF_V4L2_NV16] = {"NV16", {V4L2_PIX_FMT_NV16, V4L2_PIX_FMT_NV16M}, PF_LAYOUT_PLANE, 0},
    [PF_V4L2_NV61] = {"NV61", {V4L2_PIX_FMT_NV61, V4L2_PIX_FMT_NV61M}, PF_LAYOUT_PLANE, 0},
    [PF_V4L2_YU12] = {"YU12", {V4L2_PIX_FMT_YUV420, V4L2_PIX_FMT_YUV420M}, PF_LAYOUT_PLANE, 0},
    [PF_V4L2_YV12] = {"YV12", {V4L2_PIX_FMT_YVU420, V4L2_PIX_FMT_YVU420M}, PF_LAYOUT_PLANE, 0},
    [PF_V4L2_422P] = {"422P", {V4L2_PIX_FMT_YUV422P, V4L2_PIX_FMT_YUV422M}, PF_LAYOUT_PLANE, 0},
    [PF_V4L2_YUYV] = {"YUYV", {V4L2_PIX_FMT_YUYV}, PF_LAYOUT_PAIRS, 0},
    [PF_V4L2_YVYU] = {"YVYU", {V4L2_PIX_FMT_YVYU}, PF_LAYOUT_PAIRS, 0},
    [PF_V4L2_UYVY] = {"UYVY", {V4L2_PIX_FMT_UYVY}, PF_LAYOUT_PAIRS, 1},
    [PF_V4L2_VYUY] = {"VYUY", {V4L2_PIX_FMT_VYUY}, PF_LAYOUT_PAIRS, 1},
    [PF_V4L2_Y10P] = {"Y10P", {Y10P}, PF_LAYOUT_MIPI10, 10},
    [PF_V4L2_Y10] = {"Y10", {V4L2_PIX_FMT_Y10}, PF_LAYOUT_SAMPLE, 10},
    [PF_V4L2_Y12] = {"Y12", {V4L2_PIX_FMT_Y12}, PF_LAYOUT_SAMPLE, 12},
    [PF_V4L2_Y14] = {"Y14", {Y14}, PF_LAYOUT_SAMPLE, 14},
    [PF_V4L2_Y16] = {"Y16", {V4L2_PIX_FMT_Y16}, PF_LAYOUT_SAMPLE, 0},
    [PF_V4L2_MJPEG] = {"MJPEG", {V4L2_PIX_FMT_MJPEG, V4L2_PIX_FMT_JPEG}, PF_LAYOUT_JPEG, 0},
};

/* What lies ready as it is, what every second byte is taken of, what is computed, what is decoded. */
static const uint8_t kByCost[] = {
    PF_V4L2_GREY, PF_V4L2_NV12, PF_V4L2_NV21, PF_V4L2_YU12, PF_V4L2_YV12, PF_V4L2_NV16,
    PF_V4L2_NV61, PF_V4L2_422P, PF_V4L2_YUYV, PF_V4L2_UYVY, PF_V4L2_YVYU, PF_V4L2_VYUY,
    PF_V4L2_Y10P, PF_V4L2_Y10,  PF_V4L2_Y12,  PF_V4L2_Y14,  PF_V4L2_Y16,  PF_V4L2_MJPEG,
};

const pf_v4l2_format_row_t* pf_v4l2_format_row(uint32_t format) {
  return format < PF_V4L2_FORMATS ? &kRows[format] : NULL;
}

const char* pf_v4l2_format_name(uint32_t format) { return format < PF_V4L2_FORMATS ? kRows[format].name : NULL; }

uint32_t pf_v4l2_format_by_cost(uint32_t rank) { return rank < sizeof(kByCost) ? kByCost[rank] : PF_V4L2_ANY; }

uint32_t pf_v4l2_format_of(uint32_t fourcc) {
  for (uint32_t format = 1; format < PF_V4L2_FORMATS; ++format) {
    for (int i = 0; i < PF_FOURCCS; ++i) {
      if (fourcc != 0 && kRows[format].fourccs[i] == fourcc) {
        return format;
      }
    }
  }
  return PF_V4L2_ANY;
}

uint32_t pf_v4l2_row_bytes(uint32_t format, int32_t width) {
  const uint32_t pixels = (uint32_t)width;
  switch (kRows[format].layout) {
    case PF_LAYOUT_PAIRS:
    case PF_LAYOUT_SAMPLE:
      return 2 * pixels;
    case PF_LAYOUT_MIPI10:
      return (pixels + 3) / 4 * 5;
    case PF_LAYOUT_PLANE:
    case PF_LAYOUT_JPEG:
      break;
  }
  return pixels;
}

static int lists(const char* list, const char* name) {
  const size_t length = strlen(name);
  for (const char* at = list; at != NULL && *at != '\0'; at = strchr(at, ' ')) {
    at += *at == ' ' ? 1 : 0;
    if (strncmp(at, name, length) == 0 && (at[length] == ',' || at[length] == '\0')) {
      return 1;
    }
  }
  return 0;
}

void pf_v4l2_add_name(char* list, size_t size, const char* name) {
  const size_t used = strlen(list);
  if (!lists(list, name) && used + strlen(name) + 3 <= size) {
    snprintf(list + used, size - used, "%s%s", used > 0 ? ", " : "", name);
  }
}

void pf_v4l2_add_fourcc(char* list, size_t size, uint32_t fourcc) {
  char name[8] = "";
  for (size_t i = 0; i < 4; ++i) {
    const char letter = (char)(fourcc >> 8 * i & 0x7f);
    name[i] = letter > ' ' && letter < 0x7f ? letter : '\0';
  }
  if ((fourcc & 1u << 31) != 0) {
    memcpy(name + strlen(name), "-BE", 4);
  }
  if (name[0] != '\0') {
    pf_v4l2_add_name(list, size, name);
  }
}

void pf_v4l2_name_formats(uint32_t formats, char* list, size_t size) {
  list[0] = '\0';
  for (uint32_t rank = 0; pf_v4l2_format_by_cost(rank) != PF_V4L2_ANY; ++rank) {
    const uint32_t format = pf_v4l2_format_by_cost(rank);
    if ((formats & 1u << format) != 0) {
      pf_v4l2_add_name(list, size, kRows[format].name);
    }
  }
}
