/* A V4L2 driver that fails in every way that drivers do, under the module that reads cameras: no failure stops the camera for longer
 * than a second, and nothing leaks. The kernel's calls are wrapped (see tests/CMakeLists.txt), and time is the test's own. */
#define _GNU_SOURCE
#define _FILE_OFFSET_BITS 64 /* as the module has it */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/dma-buf.h>
#include <linux/videodev2.h>
#include <planefold_platform/camera_source.h>
#include <planefold_platform/v4l2.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unity.h>

#include "support/fake_time.h"

void setUp(void) {}
void tearDown(void) {}

enum { kWidth = 32, kHeight = 24, kMaxFaults = 4, kFirstFd = 1000, kFds = 64, kSequences = 1000 };

static const int64_t kPeriodNs = 33 * FAKE_MS;
static const int64_t kLongestStopNs = FAKE_SECOND;

typedef enum fault_kind {
  kStampsAhead, /* times an hour ahead of the clock */
  kStampsBehind,
  kStampsStill,
  kSoftFaults, /* the faults above leave good pictures, so frames have to go on */
  kShort = kSoftFaults,
  kLong,
  kMarked,
  kQueueFails,
  kTakeFails,    /* VIDIOC_DQBUF, the buffer stays */
  kTakeLoses,    /* VIDIOC_DQBUF, the buffer is gone until the stream is restarted */
  kWrongBuffer,  /* VIDIOC_DQBUF gives a buffer that the driver does not have */
  kStreamBreaks, /* the stream stops, and VIDIOC_STREAMON is refused for the time */
  kPollFails,
  kInterrupted, /* every second call ends with EINTR */
  kUnplugged,
  kFaultKinds
} fault_kind_t;

typedef struct fault {
  fault_kind_t kind;
  int64_t begin_ns, end_ns;
  int64_t at_call; /* kUnplugged begins with this call of the driver instead */
} fault_t;

/* What the driver and the kernel know. */
static struct {
  fake_random_t random;
  int64_t now_ns, calls;
  fault_t faults[kMaxFaults];
  int fault_count;
  int error;             /* with which calls fail */
  int tells_empty_queue; /* POLLERR where it has no buffer */
  int hangs_up;          /* POLLHUP where it is unplugged */
  uint32_t format, stride, length;
  int open[kFds]; /* 1: the device, 2 + i: buffer i exported */
  int maps, folders;
  int buffers, streaming, broken;
  uint8_t* memory[VIDEO_MAX_FRAME];
  int queue[VIDEO_MAX_FRAME], queued;
  struct v4l2_buffer done[VIDEO_MAX_FRAME];
  int filled;
  uint32_t sequence;
  int64_t next_frame_ns;
  int64_t restored_ns; /* when the last fault that keeps frames from coming ended */
  const char* misuse;  /* what the module did that a program must not do; null: nothing */
} fake;

static int active(fault_kind_t kind) {
  for (int i = 0; i < fake.fault_count; ++i) {
    const fault_t* fault = &fake.faults[i];
    if (fault->kind == kind && fake.now_ns >= fault->begin_ns && fake.now_ns < fault->end_ns) {
      return 1;
    }
  }
  return 0;
}

static void misused(const char* what) { fake.misuse = fake.misuse != NULL ? fake.misuse : what; }

static void fill_one(void) {
  struct v4l2_buffer* buffer = &fake.done[fake.filled];
  int64_t t_ns = fake.now_ns - 8 * FAKE_MS;
  ++fake.sequence;
  if (fake.queued == 0) {
    return;
  }
  memset(buffer, 0, sizeof(*buffer));
  buffer->index = (uint32_t)fake.queue[0];
  memmove(fake.queue, fake.queue + 1, sizeof(fake.queue[0]) * (size_t)--fake.queued);
  buffer->sequence = fake.sequence;
  buffer->bytesused = fake.length - (uint32_t)(fake.length % 2);
  buffer->bytesused = active(kShort) ? buffer->bytesused / 2 : active(kLong) ? fake.length + 1 : buffer->bytesused;
  buffer->flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | (active(kMarked) ? V4L2_BUF_FLAG_ERROR : 0u);
  t_ns += active(kStampsAhead) ? 3600 * FAKE_SECOND : active(kStampsBehind) ? -3600 * FAKE_SECOND : 0;
  t_ns = active(kStampsStill) ? 5000 * FAKE_SECOND : t_ns;
  buffer->timestamp.tv_sec = t_ns / FAKE_SECOND;
  buffer->timestamp.tv_usec = t_ns % FAKE_SECOND / 1000;
  memset(fake.memory[buffer->index], (int)(fake.sequence & 0xff), fake.length);
  ++fake.filled;
}

static void pass(int64_t ns) {
  const int64_t until_ns = fake.now_ns + ns;
  while (fake.next_frame_ns <= until_ns) {
    fake.now_ns = fake.next_frame_ns > fake.now_ns ? fake.next_frame_ns : fake.now_ns;
    fake.next_frame_ns += kPeriodNs;
    if (active(kStreamBreaks)) {
      fake.broken = 1;
    }
    if (fake.streaming && !fake.broken && !active(kUnplugged)) {
      fill_one();
    }
  }
  fake.now_ns = until_ns;
  for (int i = 0; i < fake.fault_count; ++i) {
    const fault_t* fault = &fake.faults[i];
    if (fault->kind >= kSoftFaults && fake.now_ns >= fault->begin_ns) {
      const int64_t end_ns = fake.now_ns < fault->end_ns ? fake.now_ns : fault->end_ns;
      fake.restored_ns = end_ns > fake.restored_ns ? end_ns : fake.restored_ns;
    }
  }
}

/* Every call of the kernel takes a little time, and may be the one at which the camera is unplugged. */
static void enter_call(void) {
  for (int i = 0; i < fake.fault_count; ++i) {
    fault_t* fault = &fake.faults[i];
    if (fault->kind == kUnplugged && fault->at_call == fake.calls) {
      fault->end_ns += fake.now_ns - fault->begin_ns;
      fault->begin_ns = fake.now_ns;
    }
  }
  ++fake.calls;
  pass(20000);
}

static int fails(int error) {
  errno = error;
  return -1;
}

static int is_device(int fd) { return fd >= kFirstFd && fd < kFirstFd + kFds && fake.open[fd - kFirstFd] != 0; }

static int new_fd(int what) {
  for (int i = 0; i < kFds; ++i) {
    if (fake.open[i] == 0) {
      fake.open[i] = what;
      return kFirstFd + i;
    }
  }
  return fails(EMFILE);
}

static int set_format(struct v4l2_format* format) {
  if (format->fmt.pix.pixelformat != fake.format) {
    return fails(EINVAL);
  }
  format->fmt.pix.width = kWidth;
  format->fmt.pix.height = kHeight;
  format->fmt.pix.bytesperline = fake.stride;
  format->fmt.pix.sizeimage = fake.length;
  return 0;
}

static int queue_buffer(const struct v4l2_buffer* buffer) {
  if (active(kQueueFails)) {
    return fails(fake.error);
  }
  if ((int)buffer->index >= fake.buffers) {
    misused("queues a buffer that there is not");
    return fails(EINVAL);
  }
  for (int i = 0; i < fake.queued; ++i) {
    if (fake.queue[i] == (int)buffer->index) {
      misused("queues a buffer twice");
      return fails(EINVAL);
    }
  }
  fake.queue[fake.queued++] = (int)buffer->index;
  return 0;
}

static int take_buffer(struct v4l2_buffer* buffer) {
  if (!fake.streaming) {
    return fails(EINVAL);
  }
  if (fake.broken || active(kTakeFails)) {
    return fails(fake.error);
  }
  if (fake.filled == 0) {
    return fails(EAGAIN);
  }
  *buffer = fake.done[0];
  if (active(kWrongBuffer)) {
    buffer->index = fake_random_below(&fake.random, 2) == 0 ? 99 : UINT32_MAX;
    return 0;
  }
  memmove(fake.done, fake.done + 1, sizeof(fake.done[0]) * (size_t)--fake.filled);
  return active(kTakeLoses) ? fails(EIO) : 0;
}

static int request_buffers(struct v4l2_requestbuffers* request) {
  if (request->count == 0 && fake.maps > 0) {
    misused("gives back buffers that are mapped");
  }
  request->count = request->count > 8 ? 8 : request->count;
  fake.buffers = (int)request->count;
  fake.queued = fake.filled = 0;
  return 0;
}

static int stream(int on) {
  if (on && active(kStreamBreaks)) {
    return fails(fake.error);
  }
  fake.streaming = on;
  fake.broken = 0;
  fake.filled = 0;
  if (!on) {
    fake.queued = 0;
  }
  return 0;
}

static int answer(int fd, unsigned long request, void* argument) {
  switch (request) {
    case VIDIOC_QUERYCAP: {
      struct v4l2_capability* capability = (struct v4l2_capability*)argument;
      memset(capability, 0, sizeof(*capability));
      capability->capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
      strcpy((char*)capability->card, "fake");
      strcpy((char*)capability->bus_info, "usb-1.2");
      return 0;
    }
    case VIDIOC_ENUM_FMT: {
      struct v4l2_fmtdesc* description = (struct v4l2_fmtdesc*)argument;
      description->pixelformat = fake.format;
      return description->index == 0 ? 0 : fails(EINVAL);
    }
    case VIDIOC_TRY_FMT:
    case VIDIOC_S_FMT:
      return set_format((struct v4l2_format*)argument);
    case VIDIOC_G_PARM: {
      struct v4l2_streamparm* parameters = (struct v4l2_streamparm*)argument;
      parameters->parm.capture.timeperframe.numerator = 33;
      parameters->parm.capture.timeperframe.denominator = 1000;
      return 0;
    }
    case VIDIOC_REQBUFS:
      return request_buffers((struct v4l2_requestbuffers*)argument);
    case VIDIOC_QUERYBUF: {
      struct v4l2_buffer* buffer = (struct v4l2_buffer*)argument;
      buffer->length = fake.length;
      buffer->m.offset = buffer->index * 4096;
      return 0;
    }
    case VIDIOC_EXPBUF: {
      struct v4l2_exportbuffer* exported = (struct v4l2_exportbuffer*)argument;
      exported->fd = new_fd(2 + (int)exported->index);
      return exported->fd < 0 ? -1 : 0;
    }
    case VIDIOC_QBUF:
      return queue_buffer((const struct v4l2_buffer*)argument);
    case VIDIOC_DQBUF:
      return take_buffer((struct v4l2_buffer*)argument);
    case VIDIOC_STREAMON:
    case VIDIOC_STREAMOFF:
      return stream(request == VIDIOC_STREAMON);
    case DMA_BUF_IOCTL_SYNC:
      return fake.open[fd - kFirstFd] > 1 ? 0 : fails(ENOTTY);
    default:
      return fails(EINVAL);
  }
}

/* The kernel's calls, as the module sees them. */
int __wrap_ioctl(int fd, unsigned long request, ...);
void* __wrap_mmap(void* address, size_t bytes, int protection, int flags, int fd, off_t offset);
void* __wrap_mmap64(void* address, size_t bytes, int protection, int flags, int fd, off_t offset);
int __wrap_munmap(void* address, size_t bytes);
int __wrap_poll(struct pollfd* fds, nfds_t count, int timeout_ms);
int __wrap_open(const char* path, int flags, ...);
int __wrap_open64(const char* path, int flags, ...);
int __wrap_close(int fd);
int __wrap_stat(const char* path, struct stat* status);
int __wrap_stat64(const char* path, struct stat* status);
DIR* __wrap_opendir(const char* path);
struct dirent* __wrap_readdir(DIR* folder);
struct dirent* __wrap_readdir64(DIR* folder);
int __wrap_closedir(DIR* folder);
int __wrap_clock_gettime(clockid_t clock, struct timespec* now);

int __wrap_ioctl(int fd, unsigned long request, ...) {
  va_list arguments;
  void* argument;
  va_start(arguments, request);
  argument = va_arg(arguments, void*);
  va_end(arguments);
  enter_call();
  if (!is_device(fd)) {
    misused("calls ioctl on what is not open");
    return fails(EBADF);
  }
  if (active(kInterrupted) && fake_random_below(&fake.random, 2) == 0) {
    return fails(EINTR);
  }
  return active(kUnplugged) ? fails(ENODEV) : answer(fd, request, argument);
}

void* __wrap_mmap(void* address, size_t bytes, int protection, int flags, int fd, off_t offset) {
  (void)address, (void)protection, (void)flags;
  enter_call();
  if (!is_device(fd) || bytes != fake.length) {
    misused("maps what is no buffer");
  }
  if (active(kUnplugged)) {
    errno = ENODEV;
    return MAP_FAILED;
  }
  {
    const int what = fake.open[fd - kFirstFd];
    const int index = what > 1 ? what - 2 : (int)(offset / 4096);
    fake.memory[index] = (uint8_t*)calloc(1, bytes);
    ++fake.maps;
    return fake.memory[index];
  }
}
void* __wrap_mmap64(void* address, size_t bytes, int protection, int flags, int fd, off_t offset) {
  return __wrap_mmap(address, bytes, protection, flags, fd, offset);
}

int __wrap_munmap(void* address, size_t bytes) {
  enter_call();
  if (bytes != fake.length) {
    misused("unmaps another length than it mapped");
  }
  --fake.maps;
  free(address);
  return 0;
}

int __wrap_poll(struct pollfd* fds, nfds_t count, int timeout_ms) {
  const int64_t until_ns = fake.now_ns + timeout_ms * FAKE_MS;
  if (count == 0) {
    pass(until_ns - fake.now_ns);
    return 0;
  }
  enter_call();
  if (!is_device(fds->fd)) {
    misused("polls what is not open");
    return fails(EBADF);
  }
  for (;;) {
    fds->revents = 0;
    if (active(kInterrupted) && fake_random_below(&fake.random, 2) == 0) {
      return fails(EINTR);
    }
    if (active(kPollFails)) {
      return fails(ENOMEM);
    }
    if (active(kUnplugged)) {
      fds->revents = fake.hangs_up ? POLLERR | POLLHUP : POLLERR;
    } else if (!fake.streaming || fake.broken || (fake.filled + fake.queued == 0 && fake.tells_empty_queue)) {
      fds->revents = POLLERR;
    } else if (fake.filled > 0) {
      fds->revents = POLLIN;
    }
    if (fds->revents != 0 || fake.now_ns >= until_ns) {
      return fds->revents != 0;
    }
    pass(FAKE_MS);
  }
}

int __wrap_open(const char* path, int flags, ...) {
  (void)flags;
  enter_call();
  if (strcmp(path, "/dev/video7") != 0 || active(kUnplugged)) {
    return fails(ENOENT);
  }
  return new_fd(1);
}
int __wrap_open64(const char* path, int flags, ...) { return __wrap_open(path, flags); }

int __wrap_close(int fd) {
  enter_call();
  if (!is_device(fd)) {
    misused("closes what is not open");
    return fails(EBADF);
  }
  if (fake.open[fd - kFirstFd] == 1) { /* as the kernel does when the streaming file is closed */
    fake.streaming = fake.queued = fake.filled = 0;
  }
  fake.open[fd - kFirstFd] = 0;
  return 0;
}

int __wrap_stat(const char* path, struct stat* status) {
  enter_call();
  if (strcmp(path, "/dev/video7") != 0 || active(kUnplugged)) {
    return fails(ENOENT);
  }
  memset(status, 0, sizeof(*status));
  status->st_mode = S_IFCHR | 0660;
  return 0;
}
int __wrap_stat64(const char* path, struct stat* status) { return __wrap_stat(path, status); }

static int read_entries;
DIR* __wrap_opendir(const char* path) {
  (void)path;
  ++fake.folders;
  read_entries = 0;
  return (DIR*)(void*)&fake;
}
struct dirent* __wrap_readdir(DIR* folder) {
  static struct dirent entry;
  (void)folder;
  strcpy(entry.d_name, "video7");
  return read_entries++ == 0 && !active(kUnplugged) ? &entry : NULL;
}
struct dirent* __wrap_readdir64(DIR* folder) {
  return __wrap_readdir(folder);
}
int __wrap_closedir(DIR* folder) {
  (void)folder;
  --fake.folders;
  return 0;
}

int __wrap_clock_gettime(clockid_t clock, struct timespec* now) {
  (void)clock;
  pass(1000);
  now->tv_sec = (time_t)(fake.now_ns / FAKE_SECOND);
  now->tv_nsec = (long)(fake.now_ns % FAKE_SECOND);
  return 0;
}

static void begin(uint64_t seed) {
  memset(&fake, 0, sizeof(fake));
  fake.random.state = seed;
  fake.now_ns = 10000 * FAKE_SECOND; /* the clock has run for some hours */
  fake.restored_ns = fake.now_ns;
  fake.next_frame_ns = fake.now_ns + kPeriodNs;
  fake.error = EIO;
  fake.format = V4L2_PIX_FMT_GREY;
  fake.stride = kWidth;
  fake.length = kWidth * kHeight;
}

static pf_v4l2_options_t options_of_size(void) {
  pf_v4l2_options_t options;
  pf_v4l2_options_default(&options);
  options.width = kWidth;
  options.height = kHeight;
  return options;
}

static void expect_nothing_left(const char* what) {
  char line[128];
  int open = 0;
  for (int i = 0; i < kFds; ++i) {
    open += fake.open[i] != 0;
  }
  snprintf(line, sizeof(line), "%s: %d files, %d maps and %d folders left, %s", what, open, fake.maps, fake.folders,
           fake.misuse != NULL ? fake.misuse : "no misuse");
  TEST_ASSERT_TRUE_MESSAGE(open == 0 && fake.maps == 0 && fake.folders == 0 && fake.misuse == NULL, line);
}

/* A program that watches the camera for so long: it holds some frames for a while, and opens the camera again when it left. */
typedef struct watcher {
  pf_v4l2_t* camera;
  pf_v4l2_frame_t held[8];
  int holding;
  int64_t last_t_ns, last_frame_ns, longest_stop_ns;
  int frames;
  uint64_t sum;
} watcher_t;

static void release_one(watcher_t* watcher) {
  const int which = fake_random_below(&fake.random, watcher->holding);
  pf_v4l2_release(watcher->camera, &watcher->held[which]);
  watcher->held[which] = watcher->held[--watcher->holding];
}

static void note_stop(watcher_t* watcher) {
  const int64_t since_ns = watcher->last_frame_ns > fake.restored_ns ? watcher->last_frame_ns : fake.restored_ns;
  const int64_t stop_ns = fake.now_ns - since_ns;
  watcher->longest_stop_ns = stop_ns > watcher->longest_stop_ns ? stop_ns : watcher->longest_stop_ns;
}

static void use_frame(watcher_t* watcher, const pf_v4l2_frame_t* frame) {
  TEST_ASSERT_TRUE(frame->image.t_ns > watcher->last_t_ns && frame->image.t_ns <= frame->arrived_ns);
  for (int32_t y = 0; y < frame->image.height; ++y) {
    for (int32_t x = 0; x < frame->image.width; ++x) {
      watcher->sum += frame->image.pixels[(size_t)y * (size_t)frame->image.stride + (size_t)x];
    }
  }
  watcher->last_t_ns = frame->image.t_ns;
  watcher->last_frame_ns = fake.now_ns;
  watcher->held[watcher->holding++] = *frame;
  ++watcher->frames;
}

static int watch(watcher_t* watcher, const pf_v4l2_options_t* options, int64_t duration_ns, int most_held) {
  const int64_t until_ns = fake.now_ns + duration_ns;
  char message[PF_V4L2_MESSAGE] = "";
  memset(watcher, 0, sizeof(*watcher));
  watcher->last_frame_ns = fake.now_ns;
  while (fake.now_ns < until_ns) {
    pf_v4l2_frame_t frame;
    if (watcher->camera == NULL) { /* by its place, since no name can be asked for while it is away */
      if (pf_v4l2_open("/dev/video7", options, &watcher->camera, message) != 0 ||
          pf_v4l2_start(watcher->camera, message) != 0) {
        pf_v4l2_close(watcher->camera);
        watcher->camera = NULL;
        pass(50 * FAKE_MS);
      }
      note_stop(watcher);
      continue;
    }
    switch (pf_v4l2_read(watcher->camera, 100, &frame, message)) {
      case PF_V4L2_FRAME:
        note_stop(watcher);
        use_frame(watcher, &frame);
        break;
      case PF_V4L2_NOTHING:
        break;
      case PF_V4L2_GONE:
        while (watcher->holding > 0) {
          release_one(watcher);
        }
        if (pf_v4l2_return(watcher->camera, message) != 0) {
          pass(50 * FAKE_MS);
        }
        break;
      default:
        printf("read: %s\n", message);
        return -1;
    }
    note_stop(watcher);
    while (watcher->holding > most_held || (watcher->holding > 0 && fake_random_below(&fake.random, 2) == 0)) {
      release_one(watcher);
    }
  }
  return 0;
}

static void test_camera_should_go_on_when_its_driver_fails_in_any_order(void) {
  static const uint32_t formats[] = {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_NV12, V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_Y16};
  static const int errors[] = {EIO, EINVAL, ENOMEM, EBUSY};
  int64_t longest_ns = 0;
  int64_t frames = 0;
  int64_t restarts = 0;
  int64_t departures = 0;
  for (int sequence = 0; sequence < kSequences; ++sequence) {
    const uint64_t seed = 1000 + (uint64_t)sequence;
    pf_v4l2_options_t options = options_of_size();
    watcher_t watcher;
    pf_v4l2_info_t info;
    char line[128];
    int watched;
    begin(seed);
    fake.error = errors[fake_random_below(&fake.random, 4)];
    fake.tells_empty_queue = fake_random_below(&fake.random, 2);
    fake.hangs_up = fake_random_below(&fake.random, 2);
    fake.format = formats[fake_random_below(&fake.random, 4)];
    fake.stride = (uint32_t)(2 * kWidth + 8 * fake_random_below(&fake.random, 3));
    fake.length = fake.stride * (kHeight + (uint32_t)fake_random_below(&fake.random, 2) * kHeight / 2);
    options.buffers = 2 + fake_random_below(&fake.random, 6);
    options.hand_over = (uint32_t)fake_random_below(&fake.random, 3);
    options.dma_buf = (uint32_t)fake_random_below(&fake.random, 2);
    fake.fault_count = 1 + fake_random_below(&fake.random, kMaxFaults);
    for (int i = 0; i < fake.fault_count; ++i) {
      fault_t* fault = &fake.faults[i];
      fault->kind = (fault_kind_t)fake_random_below(&fake.random, kFaultKinds);
      fault->begin_ns = fake.now_ns + fake_random_below(&fake.random, 8000) * FAKE_MS;
      fault->end_ns = fault->begin_ns + (fake_random_below(&fake.random, 3) == 0 ? 34 : 3000) * FAKE_MS;
      fault->at_call = -1;
      if (fault->kind == kUnplugged && fake_random_below(&fake.random, 2) == 0) {
        fault->at_call = fake_random_below(&fake.random, 600);
        fault->begin_ns += 1000 * FAKE_SECOND; /* until that call is reached */
        fault->end_ns += 1000 * FAKE_SECOND;
      }
    }
    watched = watch(&watcher, &options, 12 * FAKE_SECOND, fake_random_below(&fake.random, options.buffers));
    memset(&info, 0, sizeof(info));
    pf_v4l2_get_info(watcher.camera, &info);
    pf_v4l2_close(watcher.camera);
    snprintf(line, sizeof(line), "seed %llu: %d frames, longest stop %.3f s, %lld restarts, %lld departures",
             (unsigned long long)seed, watcher.frames, 1e-9 * (double)watcher.longest_stop_ns, (long long)info.restarts,
             (long long)info.departures);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, watched, line);
    TEST_ASSERT_TRUE_MESSAGE(watcher.longest_stop_ns <= kLongestStopNs, line);
    expect_nothing_left(line);
    longest_ns = watcher.longest_stop_ns > longest_ns ? watcher.longest_stop_ns : longest_ns;
    frames += watcher.frames;
    restarts += info.restarts;
    departures += info.departures;
  }
  printf("%d sequences from seed 1000: %lld frames, %lld restarts, %lld departures, longest stop %.3f s\n", kSequences,
         (long long)frames, (long long)restarts, (long long)departures, 1e-9 * (double)longest_ns);
  TEST_ASSERT_TRUE(restarts > 0 && departures > 0);
}

static int frames_with(fault_kind_t kind, int64_t begin_ms, int64_t length_ms) {
  const pf_v4l2_options_t options = options_of_size();
  watcher_t watcher;
  begin(7);
  fake.fault_count = 1;
  fake.faults[0].kind = kind;
  fake.faults[0].begin_ns = fake.now_ns + begin_ms * FAKE_MS;
  fake.faults[0].end_ns = fake.faults[0].begin_ns + length_ms * FAKE_MS;
  fake.faults[0].at_call = -1;
  TEST_ASSERT_EQUAL_INT(0, watch(&watcher, &options, 300 * kPeriodNs, 2));
  pf_v4l2_close(watcher.camera);
  expect_nothing_left("one fault");
  return watcher.frames;
}

static void test_camera_should_go_on_when_one_stamp_lies_an_hour_ahead(void) {
  TEST_ASSERT_GREATER_OR_EQUAL_INT(297, frames_with(kStampsAhead, 330, 33));
}

static void test_camera_should_go_on_when_stamps_stay_an_hour_ahead_or_behind(void) {
  TEST_ASSERT_GREATER_OR_EQUAL_INT(290, frames_with(kStampsAhead, 330, 60000));
  TEST_ASSERT_GREATER_OR_EQUAL_INT(285, frames_with(kStampsBehind, 330, 60000));
  TEST_ASSERT_GREATER_OR_EQUAL_INT(285, frames_with(kStampsStill, 330, 60000));
}

static void test_camera_should_go_on_when_buffers_were_refused(void) {
  TEST_ASSERT_GREATER_OR_EQUAL_INT(260, frames_with(kQueueFails, 330, 500));
}

static void test_open_should_refuse_a_row_longer_than_any_memory(void) {
  pf_v4l2_options_t options = options_of_size();
  char message[PF_V4L2_MESSAGE] = "";
  pf_v4l2_t* camera = NULL;
  begin(7);
  fake.stride = 0x80000000u; /* times 24 rows wraps in 32 bits */
  TEST_ASSERT_EQUAL_INT(-1, pf_v4l2_open("/dev/video7", &options, &camera, message));
  TEST_ASSERT_NOT_NULL(strstr(message, "2147483648"));
  TEST_ASSERT_NULL(camera);
  expect_nothing_left("a refused camera");
}

static void test_camera_source_should_hand_on_frames_faults_and_what_is_known(void) {
  pf_camera_source_options_t options;
  pf_camera_source_t camera;
  pf_camera_source_frame_t frame;
  pf_camera_source_info_t info;
  char message[PF_CAMERA_SOURCE_MESSAGE] = "";
  pf_camera_source_options_default(&options);
  options.width = kWidth;
  options.height = kHeight;
  options.format = "MJPG";
  begin(7);
  TEST_ASSERT_EQUAL_INT(-1, pf_v4l2_open_source("/dev/video7", &options, &camera, message));
  TEST_ASSERT_NOT_NULL(strstr(message, "MJPG"));
  TEST_ASSERT_NULL(camera.context);
  options.format = "GREY";
  TEST_ASSERT_EQUAL_INT_MESSAGE(0, pf_v4l2_open_source("/dev/video7", &options, &camera, message), message);
  TEST_ASSERT_EQUAL_INT(0, camera.start(camera.context, message));
  for (int k = 1; k <= 5; ++k) {
    TEST_ASSERT_EQUAL_INT(PF_CAMERA_SOURCE_FRAME, camera.read(camera.context, 100, &frame, message));
    TEST_ASSERT_EQUAL_INT(kWidth, frame.image.width);
    TEST_ASSERT_EQUAL_UINT8(k, frame.image.pixels[0]);
    camera.release(camera.context, &frame);
  }
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_SOURCE_NOTHING, camera.read(camera.context, 1, &frame, message));
  TEST_ASSERT_EQUAL_INT(-1, frame.buffer);
  fake.fault_count = 1;
  fake.faults[0].kind = kUnplugged;
  fake.faults[0].begin_ns = fake.now_ns;
  fake.faults[0].end_ns = fake.now_ns + FAKE_SECOND;
  fake.faults[0].at_call = -1;
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_SOURCE_GONE, camera.read(camera.context, 100, &frame, message));
  TEST_ASSERT_EQUAL_INT(-1, camera.come_back(camera.context, message));
  pass(FAKE_SECOND);
  TEST_ASSERT_EQUAL_INT(0, camera.come_back(camera.context, message));
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_SOURCE_FRAME, camera.read(camera.context, 100, &frame, message));
  camera.get_info(camera.context, &info);
  TEST_ASSERT_EQUAL_STRING("v4l2", info.interface);
  TEST_ASSERT_EQUAL_STRING("GREY", info.format);
  TEST_ASSERT_EQUAL_STRING("/dev/video7", info.id);
  TEST_ASSERT_EQUAL_STRING("end of exposure", info.timestamps);
  TEST_ASSERT_EQUAL_INT64(6, info.frames);
  TEST_ASSERT_EQUAL_INT64(1, info.departures);
  camera.close(camera.context);
  expect_nothing_left("a source");
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_camera_should_go_on_when_one_stamp_lies_an_hour_ahead);
  RUN_TEST(test_camera_should_go_on_when_stamps_stay_an_hour_ahead_or_behind);
  RUN_TEST(test_camera_should_go_on_when_buffers_were_refused);
  RUN_TEST(test_camera_source_should_hand_on_frames_faults_and_what_is_known);
  RUN_TEST(test_open_should_refuse_a_row_longer_than_any_memory);
  RUN_TEST(test_camera_should_go_on_when_its_driver_fails_in_any_order);
  return UNITY_END();
}
