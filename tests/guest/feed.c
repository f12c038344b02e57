/* Frames of a file to the output of a video loop device, over and over at their pace, in the guest of the camera tests.
 *
 *   feed OUTPUT INPUT WIDTH HEIGHT FRAMES FILE [REPEAT]
 *
 * FILE holds FRAMES grey pictures of WIDTH * HEIGHT bytes. Both nodes get the same timings, which is what lets the device
 * hand output to input. REPEAT (1) is how many periods each picture stays. */
#include <errno.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#define BUFFERS 4

static void check(int result, const char* what) {
  if (result != 0) {
    fprintf(stderr, "feed: %s: %s\n", what, strerror(errno));
    exit(1);
  }
}

/* The slowest rate from 30 Hz on that the input takes, with CVT's reduced blanking, for a picture of 4:3. The driver corrects
 * blanking and clock itself; what it then has goes to the output. */
static void set_timings(int input, int output, unsigned width, unsigned height) {
  for (unsigned rate = 30; rate <= 75; ++rate) {
    struct v4l2_dv_timings timings;
    struct v4l2_bt_timings* bt = &timings.bt;
    const unsigned lines = height + 13;
    memset(&timings, 0, sizeof(timings));
    timings.type = V4L2_DV_BT_656_1120;
    bt->width = width;
    bt->height = height;
    bt->polarities = V4L2_DV_HSYNC_POS_POL; /* stands for reduced blanking */
    bt->vfrontporch = 3;
    bt->vsync = 4; /* stands for 4:3 */
    bt->vbackporch = 6;
    bt->hfrontporch = bt->hsync = bt->hbackporch = width / 2;
    bt->pixelclock = (unsigned long long)rate * lines * (width + 3 * (width / 2));
    bt->standards = V4L2_DV_BT_STD_CVT;
    if (ioctl(input, VIDIOC_S_DV_TIMINGS, &timings) == 0) {
      check(ioctl(output, VIDIOC_S_DV_TIMINGS, &timings), "VIDIOC_S_DV_TIMINGS");
      return;
    }
  }
  check(-1, "the input takes no timings of this size");
}

static void set_control(int fd, const char* name, int value) {
  struct v4l2_queryctrl query;
  struct v4l2_control control;
  memset(&query, 0, sizeof(query));
  query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  while (ioctl(fd, VIDIOC_QUERYCTRL, &query) == 0) {
    if (strcmp((const char*)query.name, name) == 0) {
      control.id = query.id;
      control.value = value;
      check(ioctl(fd, VIDIOC_S_CTRL, &control), "VIDIOC_S_CTRL");
      return;
    }
    query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
  }
  check(-1, name);
}

int main(int argc, char** argv) {
  struct v4l2_format format;
  struct v4l2_requestbuffers request;
  unsigned char* mapped[BUFFERS];
  int type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  int repeat;
  unsigned width, height, frames;
  size_t area;
  unsigned char* pictures;
  FILE* file;
  int output, input;
  if (argc < 7) {
    return 2;
  }
  width = (unsigned)atoi(argv[3]);
  height = (unsigned)atoi(argv[4]);
  frames = (unsigned)atoi(argv[5]);
  repeat = argc > 7 ? atoi(argv[7]) : 1;
  area = (size_t)width * height;
  output = open(argv[1], O_RDWR);
  input = open(argv[2], O_RDWR);
  check(output < 0 || input < 0, "cannot open");
  set_timings(input, output, width, height);
  set_control(input, "Loop Video", 1);
  set_control(input, "OSD Text Mode", 2); /* nothing is written into the pictures */
  close(input);
  pictures = malloc(area * frames);
  file = fopen(argv[6], "rb");
  check(file == NULL || pictures == NULL || fread(pictures, area, frames, file) != frames, "cannot read the pictures");
  fclose(file);

  memset(&format, 0, sizeof(format));
  format.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  format.fmt.pix.width = width;
  format.fmt.pix.height = height;
  format.fmt.pix.pixelformat = V4L2_PIX_FMT_GREY;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  check(ioctl(output, VIDIOC_S_FMT, &format), "VIDIOC_S_FMT");
  check(format.fmt.pix.width != width || format.fmt.pix.height != height || format.fmt.pix.bytesperline != width ||
            format.fmt.pix.pixelformat != V4L2_PIX_FMT_GREY,
        "the output took another format");
  memset(&request, 0, sizeof(request));
  request.count = BUFFERS;
  request.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
  request.memory = V4L2_MEMORY_MMAP;
  check(ioctl(output, VIDIOC_REQBUFS, &request), "VIDIOC_REQBUFS");
  check(request.count != BUFFERS, "other buffers than asked for");
  printf("feed: ready\n");
  fflush(stdout);
  for (unsigned i = 0;; ++i) {
    struct v4l2_buffer buffer;
    const unsigned picture = i / (unsigned)repeat % frames;
    memset(&buffer, 0, sizeof(buffer));
    buffer.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    buffer.memory = V4L2_MEMORY_MMAP;
    if (i < BUFFERS) {
      buffer.index = i;
      check(ioctl(output, VIDIOC_QUERYBUF, &buffer), "VIDIOC_QUERYBUF");
      mapped[i] = mmap(NULL, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, output, buffer.m.offset);
      check(mapped[i] == MAP_FAILED, "mmap");
    } else {
      check(ioctl(output, VIDIOC_DQBUF, &buffer), "VIDIOC_DQBUF");
    }
    memcpy(mapped[buffer.index], pictures + area * picture, area);
    buffer.bytesused = (unsigned)area;
    buffer.field = V4L2_FIELD_NONE;
    check(ioctl(output, VIDIOC_QBUF, &buffer), "VIDIOC_QBUF");
    if (i + 1 == BUFFERS) {
      check(ioctl(output, VIDIOC_STREAMON, &type), "VIDIOC_STREAMON");
    }
  }
}
