/* Every pixel format, by the single-planar and the multi-planar interface, through a driver that is played here; and what is said of a
 * camera that has none of them. */
#define _GNU_SOURCE
#define _FILE_OFFSET_BITS 64 /* as the module has it */
#include <errno.h>
#include <linux/videodev2.h>
#include <planefold_platform/v4l2.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unity.h>

void setUp(void) {}
void tearDown(void) {}

enum { kWidth = 36, kHeight = 20, kPadding = 12, kBuffers = 4, kPlaneAlign = 4096, kFormats = 3 };

/* The camera that is played. */
static struct {
  uint32_t fourccs[kFormats]; /* 0 where there are fewer */
  int multi_planar;
  uint32_t planes, data_offset;
  uint32_t set; /* the format in use */
  uint32_t stride, length;
  void (*paint)(uint8_t* picture, uint32_t number);
  uint8_t* memory[kBuffers];
  int queue[kBuffers], queued, mapped;
  uint32_t number;
  const char* misuse;
} fake;

static int fails(int error) {
  errno = error;
  return -1;
}

static int is_type(uint32_t type) {
  const uint32_t right = fake.multi_planar ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (type != right) {
    fake.misuse = "a call with the other interface's type of buffer";
  }
  return type == right;
}

/* Whether a buffer is named as the interface wants it. */
static int is_named(const struct v4l2_buffer* buffer) {
  if (fake.multi_planar && (buffer->m.planes == NULL || buffer->length != fake.planes)) {
    fake.misuse = "a buffer without its planes";
    return 0;
  }
  return is_type(buffer->type);
}

static int describe_format(struct v4l2_fmtdesc* description) {
  if (!is_type(description->type) || description->index >= kFormats || fake.fourccs[description->index] == 0) {
    return fails(EINVAL);
  }
  description->pixelformat = fake.fourccs[description->index];
  return 0;
}

/* Unknown formats become the first one, as drivers do. */
static uint32_t nearest_format(uint32_t fourcc) {
  for (int i = 0; i < kFormats; ++i) {
    if (fake.fourccs[i] == fourcc) {
      return fourcc;
    }
  }
  return fake.fourccs[0];
}

static int grant_format(struct v4l2_format* format) {
  if (!is_type(format->type)) {
    return fails(EINVAL);
  }
  if (fake.multi_planar) {
    struct v4l2_pix_format_mplane* pixels = &format->fmt.pix_mp;
    pixels->pixelformat = fake.set = nearest_format(pixels->pixelformat);
    pixels->width = kWidth;
    pixels->height = kHeight;
    pixels->num_planes = (uint8_t)fake.planes;
    pixels->plane_fmt[0].bytesperline = fake.stride;
  } else {
    struct v4l2_pix_format* pixels = &format->fmt.pix;
    pixels->pixelformat = fake.set = nearest_format(pixels->pixelformat);
    pixels->width = kWidth;
    pixels->height = kHeight;
    pixels->bytesperline = fake.stride;
  }
  return 0;
}

static int tell_buffer(struct v4l2_buffer* buffer) {
  if (!is_named(buffer)) {
    return fails(EINVAL);
  }
  if (fake.multi_planar) {
    buffer->m.planes[0].length = fake.length;
    buffer->m.planes[0].m.mem_offset = buffer->index * kPlaneAlign;
  } else {
    buffer->length = fake.length;
    buffer->m.offset = buffer->index * kPlaneAlign;
  }
  return 0;
}

static int give_buffer(struct v4l2_buffer* buffer) {
  struct timespec now;
  if (!is_named(buffer)) {
    return fails(EINVAL);
  }
  if (fake.queued == 0) {
    return fails(EAGAIN);
  }
  clock_gettime(CLOCK_MONOTONIC, &now);
  buffer->index = (uint32_t)fake.queue[0];
  memmove(fake.queue, fake.queue + 1, sizeof(fake.queue[0]) * (size_t)--fake.queued);
  buffer->sequence = fake.number;
  buffer->flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  buffer->timestamp.tv_sec = now.tv_sec;
  buffer->timestamp.tv_usec = now.tv_nsec / 1000;
  memset(fake.memory[buffer->index], 0xa5, fake.length);
  fake.paint(fake.memory[buffer->index] + fake.data_offset, fake.number++);
  if (fake.multi_planar) {
    buffer->m.planes[0].bytesused = fake.length;
    buffer->m.planes[0].data_offset = fake.data_offset;
  } else {
    buffer->bytesused = fake.length;
  }
  return 0;
}

int __wrap_ioctl(int fd, unsigned long request, void* argument);
int __wrap_ioctl(int fd, unsigned long request, void* argument) {
  (void)fd;
  switch (request) {
    case VIDIOC_QUERYCAP: {
      struct v4l2_capability* capability = (struct v4l2_capability*)argument;
      capability->capabilities =
          V4L2_CAP_STREAMING | (fake.multi_planar ? V4L2_CAP_VIDEO_CAPTURE_MPLANE : V4L2_CAP_VIDEO_CAPTURE);
      return 0;
    }
    case VIDIOC_ENUM_FMT:
      return describe_format((struct v4l2_fmtdesc*)argument);
    case VIDIOC_TRY_FMT:
    case VIDIOC_S_FMT:
      return grant_format((struct v4l2_format*)argument);
    case VIDIOC_REQBUFS: {
      struct v4l2_requestbuffers* buffers = (struct v4l2_requestbuffers*)argument;
      buffers->count = buffers->count < kBuffers ? buffers->count : kBuffers;
      return is_type(buffers->type) ? 0 : fails(EINVAL);
    }
    case VIDIOC_QUERYBUF:
      return tell_buffer((struct v4l2_buffer*)argument);
    case VIDIOC_QBUF:
      fake.queue[fake.queued++] = (int)((struct v4l2_buffer*)argument)->index;
      return is_named((struct v4l2_buffer*)argument) ? 0 : fails(EINVAL);
    case VIDIOC_DQBUF:
      return give_buffer((struct v4l2_buffer*)argument);
    case VIDIOC_STREAMON:
    case VIDIOC_STREAMOFF:
      return is_type((uint32_t) * (int*)argument) ? 0 : fails(EINVAL);
    default:
      return fails(EINVAL);
  }
}

void* __wrap_mmap(void* at, size_t length, int protection, int flags, int fd, off_t offset);
void* __wrap_mmap(void* at, size_t length, int protection, int flags, int fd, off_t offset) {
  const size_t index = (size_t)offset / kPlaneAlign;
  (void)at, (void)protection, (void)flags, (void)fd;
  if (index >= kBuffers || length != fake.length) {
    fake.misuse = "a map that is no buffer";
    return MAP_FAILED;
  }
  ++fake.mapped;
  fake.memory[index] = (uint8_t*)malloc(length);
  return fake.memory[index];
}
void* __wrap_mmap64(void* at, size_t length, int protection, int flags, int fd, off_t offset);
void* __wrap_mmap64(void* at, size_t length, int protection, int flags, int fd, off_t offset) {
  return __wrap_mmap(at, length, protection, flags, fd, offset);
}
int __wrap_munmap(void* at, size_t length);
int __wrap_munmap(void* at, size_t length) {
  (void)length;
  --fake.mapped;
  free(at);
  return 0;
}
int __wrap_poll(struct pollfd* files, nfds_t count, int timeout_ms);
int __wrap_poll(struct pollfd* files, nfds_t count, int timeout_ms) {
  (void)timeout_ms;
  if (count > 0) {
    files->revents = POLLIN;
  }
  return (int)count;
}

/* Grey level of a pixel, out of 255. */
static uint8_t level(int x, int y) { return (uint8_t)((7 * x + 11 * y) & 0xff); }

static void paint_plane(uint8_t* picture, uint32_t number) {
  (void)number;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      picture[(size_t)y * fake.stride + (size_t)x] = level(x, y);
    }
  }
}

static void paint_pairs(uint8_t* picture, int first) {
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      picture[(size_t)y * fake.stride + 2 * (size_t)x + (size_t)first] = level(x, y);
    }
  }
}
static void paint_first_of_pairs(uint8_t* picture, uint32_t number) { (void)number, paint_pairs(picture, 0); }
static void paint_second_of_pairs(uint8_t* picture, uint32_t number) { (void)number, paint_pairs(picture, 1); }

static void paint_mipi10(uint8_t* picture, uint32_t number) {
  (void)number;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      picture[(size_t)y * fake.stride + (size_t)(x / 4 * 5 + x % 4)] = level(x, y);
    }
  }
}

/* Samples of so many bits, brought up by shift; what is below of the grey level varies. */
static void paint_samples(uint8_t* picture, int bits, int shift) {
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const unsigned below = (unsigned)(x + 3 * y) & ((1u << (bits - 8)) - 1);
      const unsigned value = ((unsigned)level(x, y) << (bits - 8) | below) << shift;
      uint8_t* sample = picture + (size_t)y * fake.stride + 2 * (size_t)x;
      sample[0] = (uint8_t)(value & 0xff);
      sample[1] = (uint8_t)(value >> 8);
    }
  }
}
static void paint_10(uint8_t* picture, uint32_t number) { (void)number, paint_samples(picture, 10, 0); }
static void paint_12(uint8_t* picture, uint32_t number) { (void)number, paint_samples(picture, 12, 0); }
static void paint_14(uint8_t* picture, uint32_t number) { (void)number, paint_samples(picture, 14, 0); }
static void paint_16(uint8_t* picture, uint32_t number) { (void)number, paint_samples(picture, 16, 0); }
static void paint_10_of_16(uint8_t* picture, uint32_t number) { (void)number, paint_samples(picture, 10, 6); }
static void paint_brighter(uint8_t* picture, uint32_t number) { paint_samples(picture, number == 0 ? 10 : 12, 0); }

static pf_v4l2_t* open_fake(char message[PF_V4L2_MESSAGE]) {
  pf_v4l2_options_t options;
  pf_v4l2_t* camera = NULL;
  pf_v4l2_options_default(&options);
  options.width = kWidth;
  options.height = kHeight;
  pf_v4l2_open("/dev/null", &options, &camera, message);
  return camera;
}

/* A camera with one format whose rows have padding. */
static void play(uint32_t fourcc, uint32_t row_bytes, void (*paint)(uint8_t*, uint32_t)) {
  memset(&fake, 0, sizeof(fake));
  fake.fourccs[0] = fourcc;
  fake.planes = 1;
  fake.stride = row_bytes + kPadding;
  fake.length = fake.stride * kHeight;
  fake.paint = paint;
}

/* The frames that come from it show the picture, and its samples have that many bits. */
static void expect_picture(int frames, uint32_t bits, const char* what) {
  char message[PF_V4L2_MESSAGE] = "";
  pf_v4l2_info_t info;
  pf_v4l2_t* camera = open_fake(message);
  TEST_ASSERT_NOT_NULL_MESSAGE(camera, message);
  TEST_ASSERT_EQUAL_INT_MESSAGE(0, pf_v4l2_start(camera, message), message);
  for (int k = 0; k < frames; ++k) {
    pf_v4l2_frame_t frame;
    TEST_ASSERT_EQUAL_INT_MESSAGE(PF_V4L2_FRAME, pf_v4l2_read(camera, 10, &frame, message), what);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        TEST_ASSERT_EQUAL_UINT8_MESSAGE(level(x, y), frame.image.pixels[y * frame.image.stride + x], what);
      }
    }
    pf_v4l2_release(camera, &frame);
  }
  pf_v4l2_get_info(camera, &info);
  TEST_ASSERT_EQUAL_UINT32_MESSAGE(bits, info.bits, what);
  pf_v4l2_close(camera);
  TEST_ASSERT_NULL_MESSAGE(fake.misuse, fake.misuse);
  TEST_ASSERT_EQUAL_INT_MESSAGE(0, fake.mapped, what);
}

static const struct {
  uint32_t fourcc;
  int row_bytes;
  void (*paint)(uint8_t*, uint32_t);
  uint32_t bits;
} kCameras[] = {
    {V4L2_PIX_FMT_GREY, kWidth, paint_plane, 0},
    {V4L2_PIX_FMT_NV12, kWidth, paint_plane, 0},
    {V4L2_PIX_FMT_NV21, kWidth, paint_plane, 0},
    {V4L2_PIX_FMT_NV16, kWidth, paint_plane, 0},
    {V4L2_PIX_FMT_NV61, kWidth, paint_plane, 0},
    {V4L2_PIX_FMT_YUV420, kWidth, paint_plane, 0},
    {V4L2_PIX_FMT_YVU420, kWidth, paint_plane, 0},
    {V4L2_PIX_FMT_YUV422P, kWidth, paint_plane, 0},
    {V4L2_PIX_FMT_YUYV, 2 * kWidth, paint_first_of_pairs, 0},
    {V4L2_PIX_FMT_YVYU, 2 * kWidth, paint_first_of_pairs, 0},
    {V4L2_PIX_FMT_UYVY, 2 * kWidth, paint_second_of_pairs, 0},
    {V4L2_PIX_FMT_VYUY, 2 * kWidth, paint_second_of_pairs, 0},
    {V4L2_PIX_FMT_Y10, 2 * kWidth, paint_10, 10},
    {V4L2_PIX_FMT_Y12, 2 * kWidth, paint_12, 12},
    {v4l2_fourcc('Y', '1', '4', ' '), 2 * kWidth, paint_14, 14},
    {v4l2_fourcc('Y', '1', '0', 'P'), kWidth / 4 * 5, paint_mipi10, 0},
    {V4L2_PIX_FMT_Y16, 2 * kWidth, paint_10, 10},
    {V4L2_PIX_FMT_Y16, 2 * kWidth, paint_12, 12},
    {V4L2_PIX_FMT_Y16, 2 * kWidth, paint_14, 14},
    {V4L2_PIX_FMT_Y16, 2 * kWidth, paint_16, 16},
    {V4L2_PIX_FMT_Y16, 2 * kWidth, paint_10_of_16, 16},
};
enum { kCameraCount = sizeof(kCameras) / sizeof(kCameras[0]) };

static void test_every_format_should_give_its_grey_levels(void) {
  for (int i = 0; i < kCameraCount; ++i) {
    for (int multi_planar = 0; multi_planar < 2; ++multi_planar) {
      char what[64];
      play(kCameras[i].fourcc, (uint32_t)kCameras[i].row_bytes, kCameras[i].paint);
      fake.multi_planar = multi_planar;
      snprintf(what, sizeof(what), "camera %d, %s", i, multi_planar ? "multi-planar" : "single-planar");
      expect_picture(3, kCameras[i].bits, what);
    }
  }
}

static void test_planes_of_their_own_should_give_the_first(void) {
  const uint32_t fourccs[] = {V4L2_PIX_FMT_NV12M, V4L2_PIX_FMT_NV21M, V4L2_PIX_FMT_YUV420M, V4L2_PIX_FMT_YVU420M};
  for (size_t i = 0; i < sizeof(fourccs) / sizeof(fourccs[0]); ++i) {
    play(fourccs[i], kWidth, paint_plane);
    fake.multi_planar = 1;
    fake.planes = i < 2 ? 2 : 3;
    expect_picture(3, 0, "planes of their own");
  }
}

static void test_picture_should_begin_where_the_driver_says(void) {
  play(V4L2_PIX_FMT_GREY, kWidth, paint_plane);
  fake.multi_planar = 1;
  fake.data_offset = 64;
  fake.length += 64;
  expect_picture(3, 0, "an offset");
}

static void test_samples_should_get_darker_when_brighter_ones_come(void) {
  play(V4L2_PIX_FMT_Y16, 2 * kWidth, paint_brighter);
  expect_picture(3, 12, "first 10 bits, then 12");
}

static void expect_refusal(const char* a, const char* b) {
  char message[PF_V4L2_MESSAGE] = "";
  TEST_ASSERT_NULL(open_fake(message));
  TEST_ASSERT_NOT_NULL_MESSAGE(strstr(message, a), message);
  TEST_ASSERT_NOT_NULL_MESSAGE(strstr(message, b), message);
  TEST_ASSERT_NULL_MESSAGE(strchr(message, '\n'), message);
}

static void test_unknown_formats_should_be_named(void) {
  play(V4L2_PIX_FMT_H264, kWidth, paint_plane);
  fake.fourccs[1] = V4L2_PIX_FMT_SGRBG8;
  fake.fourccs[2] = V4L2_PIX_FMT_Y16_BE;
  expect_refusal("gives H264, GRBG, Y16-BE only", "read are GREY, NV12");
  fake.fourccs[0] = fake.fourccs[1] = fake.fourccs[2] = 0;
  expect_refusal("names no format", "/dev/null");
}

static void test_wanted_format_should_be_refused_by_what_there_is(void) {
  char message[PF_V4L2_MESSAGE] = "";
  pf_v4l2_options_t options;
  pf_v4l2_t* camera = NULL;
  play(V4L2_PIX_FMT_UYVY, 2 * kWidth, paint_second_of_pairs);
  fake.fourccs[1] = V4L2_PIX_FMT_Y10;
  fake.fourccs[2] = V4L2_PIX_FMT_H264;
  pf_v4l2_options_default(&options);
  options.width = kWidth;
  options.height = kHeight;
  options.format = PF_V4L2_GREY;
  TEST_ASSERT_EQUAL_INT(-1, pf_v4l2_open("/dev/null", &options, &camera, message));
  TEST_ASSERT_NOT_NULL_MESSAGE(strstr(message, "does not give GREY; it gives UYVY, Y10, and"), message);
  TEST_ASSERT_NOT_NULL_MESSAGE(strstr(message, "H264"), message);
  options.format = PF_V4L2_Y10;
  TEST_ASSERT_EQUAL_INT_MESSAGE(0, pf_v4l2_open("/dev/null", &options, &camera, message), message);
  pf_v4l2_close(camera);
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_every_format_should_give_its_grey_levels);
  RUN_TEST(test_planes_of_their_own_should_give_the_first);
  RUN_TEST(test_picture_should_begin_where_the_driver_says);
  RUN_TEST(test_samples_should_get_darker_when_brighter_ones_come);
  RUN_TEST(test_unknown_formats_should_be_named);
  RUN_TEST(test_wanted_format_should_be_refused_by_what_there_is);
  return UNITY_END();
}
