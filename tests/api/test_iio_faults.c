/* An inertial unit whose driver fails in every way that drivers do, under the module that reads such units: no failure stops the samples
 * for longer than a second, and nothing leaks. libiio and the kernel's calls are wrapped (see tests/CMakeLists.txt), and time is the
 * test's own. */
#define _GNU_SOURCE
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <iio.h>
#include <math.h>
#include <planefold_platform/iio.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include <unity.h>

#include "support/fake_time.h"

void setUp(void) {}
void tearDown(void) {}

enum { kMaxFaults = 4, kFirstFd = 1000, kFds = 64, kSequences = 1000, kKept = 512, kAxes = 3 };

static const int64_t kPeriodNs = 5 * FAKE_MS;
static const int64_t kLongestStopNs = FAKE_SECOND;

typedef enum fault_kind {
  kStampsAhead, /* times an hour ahead of the clock */
  kStampsBehind,
  kStampsStill,
  kSoftFaults, /* the faults above leave good samples, so these have to go on */
  kReadFails = kSoftFaults,
  kReadIsShort, /* a part of a scan */
  kWriteFails,  /* files of sysfs */
  kPollFails,
  kPollTellsError,
  kInterrupted, /* every second call ends with EINTR */
  kUnplugged,
  kFaultKinds
} fault_kind_t;

typedef struct fault {
  fault_kind_t kind;
  int64_t begin_ns, end_ns;
  int64_t at_call; /* kUnplugged begins with this call instead */
} fault_t;

struct iio_context {
  int unused;
};
struct iio_channel {
  const char* id;
  long index;
  struct iio_data_format format;
};
struct iio_device {
  const char *id, *name;
  int gyro, accel, trigger, timed;
  struct iio_channel channel[7];
  int streaming;
  int scans; /* that wait */
  int64_t times[kKept];
};

enum { kDeviceCount = 3 };

static struct {
  fake_random_t random;
  int64_t now_ns, calls;
  fault_t faults[kMaxFaults];
  int fault_count;
  int error;
  int split; /* two devices in place of one */
  int real_time;
  struct iio_context context;
  struct iio_device device[kDeviceCount];
  int open[kFds]; /* 1 + i: device i, 100 + i: a file of its sysfs folder, named in path */
  char path[kFds][96];
  int contexts, folders, entries;
  int64_t next_scan_ns;
  int64_t restored_ns;
  const char* misuse;
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

static void measure(void) {
  int64_t t_ns = fake.now_ns - FAKE_MS + (fake.real_time ? 1700000000 * FAKE_SECOND : 0);
  t_ns += active(kStampsAhead) ? 3600 * FAKE_SECOND : active(kStampsBehind) ? -3600 * FAKE_SECOND : 0;
  t_ns = active(kStampsStill) ? fake.now_ns / FAKE_SECOND / 100 * 100 * FAKE_SECOND : t_ns;
  for (int d = 0; d < kDeviceCount; ++d) {
    struct iio_device* device = &fake.device[d];
    if (device->streaming && device->scans < kKept) {
      device->times[device->scans++] = t_ns;
    }
  }
}

static void pass(int64_t ns) {
  const int64_t until_ns = fake.now_ns + ns;
  while (fake.next_scan_ns <= until_ns) {
    fake.now_ns = fake.next_scan_ns > fake.now_ns ? fake.next_scan_ns : fake.now_ns;
    fake.next_scan_ns += kPeriodNs;
    if (!active(kUnplugged)) {
      measure();
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

/* Every call takes a little time, and may be the one at which the unit is unplugged. */
static void enter_call(void) {
  for (int i = 0; i < fake.fault_count; ++i) {
    fault_t* fault = &fake.faults[i];
    if (fault->kind == kUnplugged && fault->at_call == fake.calls) {
      fault->end_ns += fake.now_ns - fault->begin_ns;
      fault->begin_ns = fake.now_ns;
    }
  }
  ++fake.calls;
  pass(10000);
  if (active(kUnplugged)) {
    for (int d = 0; d < kDeviceCount; ++d) {
      fake.device[d].streaming = fake.device[d].scans = 0;
    }
  }
}

static int fails(int error) {
  errno = error;
  return -1;
}

static int interrupted(void) { return active(kInterrupted) && fake_random_below(&fake.random, 2) == 0; }

/* libiio, as the module sees it. */
struct iio_context* __wrap_iio_create_local_context(void);
void __wrap_iio_context_destroy(struct iio_context* context);
unsigned int __wrap_iio_context_get_devices_count(const struct iio_context* context);
struct iio_device* __wrap_iio_context_get_device(const struct iio_context* context, unsigned int index);
const char* __wrap_iio_device_get_id(const struct iio_device* device);
const char* __wrap_iio_device_get_name(const struct iio_device* device);
bool __wrap_iio_device_is_trigger(const struct iio_device* device);
int __wrap_iio_device_get_trigger(const struct iio_device* device, const struct iio_device** trigger);
int __wrap_iio_device_set_trigger(const struct iio_device* device, const struct iio_device* trigger);
struct iio_channel* __wrap_iio_device_find_channel(const struct iio_device* device, const char* name, bool output);
ssize_t __wrap_iio_device_attr_read(const struct iio_device* device, const char* name, char* text, size_t bytes);
ssize_t __wrap_iio_device_attr_write(const struct iio_device* device, const char* name, const char* text);
int __wrap_iio_device_attr_read_double(const struct iio_device* device, const char* name, double* value);
int __wrap_iio_device_attr_write_double(const struct iio_device* device, const char* name, double value);
ssize_t __wrap_iio_channel_attr_read(const struct iio_channel* channel, const char* name, char* text, size_t bytes);
int __wrap_iio_channel_attr_read_double(const struct iio_channel* channel, const char* name, double* value);
int __wrap_iio_channel_attr_write_double(const struct iio_channel* channel, const char* name, double value);
const struct iio_data_format* __wrap_iio_channel_get_data_format(const struct iio_channel* channel);
const char* __wrap_iio_channel_get_id(const struct iio_channel* channel);
long __wrap_iio_channel_get_index(const struct iio_channel* channel);
bool __wrap_iio_channel_is_scan_element(const struct iio_channel* channel);

struct iio_context* __wrap_iio_create_local_context(void) {
  enter_call();
  ++fake.contexts;
  return &fake.context;
}
void __wrap_iio_context_destroy(struct iio_context* context) {
  (void)context;
  --fake.contexts;
}
unsigned int __wrap_iio_context_get_devices_count(const struct iio_context* context) {
  (void)context;
  return active(kUnplugged) ? 0 : kDeviceCount;
}
struct iio_device* __wrap_iio_context_get_device(const struct iio_context* context, unsigned int index) {
  (void)context;
  return &fake.device[index];
}
const char* __wrap_iio_device_get_id(const struct iio_device* device) { return device->id; }
const char* __wrap_iio_device_get_name(const struct iio_device* device) { return device->name; }
bool __wrap_iio_device_is_trigger(const struct iio_device* device) { return device->trigger != 0; }
int __wrap_iio_device_get_trigger(const struct iio_device* device, const struct iio_device** trigger) {
  (void)device;
  *trigger = NULL;
  return 0;
}
int __wrap_iio_device_set_trigger(const struct iio_device* device, const struct iio_device* trigger) {
  (void)device, (void)trigger;
  enter_call();
  return active(kUnplugged) ? -ENODEV : active(kWriteFails) ? -fake.error : 0;
}
struct iio_channel* __wrap_iio_device_find_channel(const struct iio_device* device, const char* name, bool output) {
  struct iio_device* its = &fake.device[device - fake.device];
  for (int i = 0; i < 7 && !output; ++i) {
    const int there = i < kAxes ? device->gyro : i < 2 * kAxes ? device->accel : device->timed;
    if (there && strcmp(its->channel[i].id, name) == 0) {
      return &its->channel[i];
    }
  }
  return NULL;
}
ssize_t __wrap_iio_device_attr_read(const struct iio_device* device, const char* name, char* text, size_t bytes) {
  (void)device;
  enter_call();
  if (strcmp(name, "current_timestamp_clock") != 0 || active(kUnplugged)) {
    return -ENOENT;
  }
  return snprintf(text, bytes, "%s\n", fake.real_time ? "realtime" : "monotonic");
}
ssize_t __wrap_iio_device_attr_write(const struct iio_device* device, const char* name, const char* text) {
  (void)device, (void)name;
  enter_call();
  return active(kUnplugged) ? -ENODEV : active(kWriteFails) ? -fake.error : (ssize_t)strlen(text);
}
int __wrap_iio_device_attr_read_double(const struct iio_device* device, const char* name, double* value) {
  (void)device, (void)name, (void)value;
  return -ENOENT;
}
int __wrap_iio_device_attr_write_double(const struct iio_device* device, const char* name, double value) {
  (void)device, (void)name, (void)value;
  return -ENOENT;
}
ssize_t __wrap_iio_channel_attr_read(const struct iio_channel* channel, const char* name, char* text, size_t bytes) {
  (void)channel, (void)name, (void)text, (void)bytes;
  return -ENOENT;
}
int __wrap_iio_channel_attr_read_double(const struct iio_channel* channel, const char* name, double* value) {
  (void)channel;
  enter_call();
  *value = strcmp(name, "scale") == 0 ? 0.001 : strcmp(name, "sampling_frequency") == 0 ? 200.0 : 0.0;
  return active(kUnplugged) ? -ENODEV : 0;
}
int __wrap_iio_channel_attr_write_double(const struct iio_channel* channel, const char* name, double value) {
  (void)channel, (void)name, (void)value;
  return 0;
}
const struct iio_data_format* __wrap_iio_channel_get_data_format(const struct iio_channel* channel) {
  return &channel->format;
}
const char* __wrap_iio_channel_get_id(const struct iio_channel* channel) { return channel->id; }
long __wrap_iio_channel_get_index(const struct iio_channel* channel) { return channel->index; }
bool __wrap_iio_channel_is_scan_element(const struct iio_channel* channel) { return channel->format.length > 0; }

/* The kernel's calls, likewise. */
int __wrap_open(const char* path, int flags, ...);
int __wrap_open64(const char* path, int flags, ...);
int __wrap_close(int fd);
ssize_t __wrap_read(int fd, void* bytes, size_t count);
ssize_t __wrap___read_chk(int fd, void* bytes, size_t count, size_t room);
ssize_t __wrap_write(int fd, const void* bytes, size_t count);
int __wrap_access(const char* path, int how);
int __wrap_poll(struct pollfd* fds, nfds_t count, int timeout_ms);
int __wrap___poll_chk(struct pollfd* fds, nfds_t count, int timeout_ms, size_t room);
DIR* __wrap_opendir(const char* path);
struct dirent* __wrap_readdir(DIR* folder);
struct dirent* __wrap_readdir64(DIR* folder);
int __wrap_closedir(DIR* folder);
int __wrap_clock_gettime(clockid_t clock, struct timespec* now);

static int what_is(int fd) { return fd >= kFirstFd && fd < kFirstFd + kFds ? fake.open[fd - kFirstFd] : 0; }

int __wrap_open(const char* path, int flags, ...) {
  int slot = 0;
  (void)flags;
  enter_call();
  if (interrupted()) {
    return fails(EINTR);
  }
  if (active(kUnplugged)) {
    return fails(ENOENT);
  }
  while (slot < kFds && fake.open[slot] != 0) {
    ++slot;
  }
  if (slot == kFds) {
    return fails(EMFILE);
  }
  for (int d = 0; d < kDeviceCount; ++d) {
    const char* found = strstr(path, fake.device[d].id);
    if (found != NULL) {
      const char* rest = found + strlen(fake.device[d].id);
      fake.open[slot] = *rest == '\0' ? 1 + d : 100 + d;
      snprintf(fake.path[slot], sizeof(fake.path[slot]), "%s", rest);
      return kFirstFd + slot;
    }
  }
  return fails(ENOENT);
}
int __wrap_open64(const char* path, int flags, ...) { return __wrap_open(path, flags); }

int __wrap_close(int fd) {
  enter_call();
  if (what_is(fd) == 0) {
    misused("closes what is not open");
    return fails(EBADF);
  }
  fake.open[fd - kFirstFd] = 0;
  return 0;
}

ssize_t __wrap_read(int fd, void* bytes, size_t count) {
  const int what = what_is(fd);
  struct iio_device* device = &fake.device[what >= 1 && what <= kDeviceCount ? what - 1 : 0];
  size_t scans;
  enter_call();
  if (what < 1 || what > kDeviceCount) {
    misused("reads what is no device");
    return fails(EBADF);
  }
  if (active(kUnplugged)) {
    return fails(ENODEV);
  }
  if (interrupted()) {
    return fails(EINTR);
  }
  if (active(kReadFails)) {
    return fails(fake.error);
  }
  if (active(kReadIsShort)) {
    memset(bytes, 1, 1);
    return 1;
  }
  if (!device->streaming) {
    return fails(EBUSY);
  }
  {
    /* axes of 16 bits in front, the time at the next multiple of 8 */
    const size_t axes = (size_t)(2 * kAxes * (device->gyro + device->accel));
    const size_t time_at = (axes + 7) / 8 * 8;
    const size_t bytes_each = device->timed ? time_at + 8 : axes;
    unsigned char* to = (unsigned char*)bytes;
    scans = count / bytes_each < (size_t)device->scans ? count / bytes_each : (size_t)device->scans;
    for (size_t s = 0; s < scans; ++s, to += bytes_each) {
      memset(to, (int)(s & 0x7f), bytes_each);
      if (device->timed) {
        memcpy(to + time_at, &device->times[s], 8);
      }
    }
    device->scans -= (int)scans;
    memmove(device->times, device->times + scans, sizeof(device->times[0]) * (size_t)device->scans);
    return scans > 0 ? (ssize_t)(scans * bytes_each) : fails(EAGAIN);
  }
}
ssize_t __wrap___read_chk(int fd, void* bytes, size_t count, size_t room) {
  (void)room;
  return __wrap_read(fd, bytes, count);
}

ssize_t __wrap_write(int fd, const void* bytes, size_t count) {
  const int what = what_is(fd);
  enter_call();
  if (what < 100) {
    misused("writes to what is no file of sysfs");
    return fails(EBADF);
  }
  if (active(kUnplugged)) {
    return fails(ENODEV);
  }
  if (interrupted()) {
    return fails(EINTR);
  }
  if (active(kWriteFails)) {
    return fails(fake.error);
  }
  if (strcmp(fake.path[fd - kFirstFd], "/buffer/enable") == 0) {
    fake.device[what - 100].streaming = ((const char*)bytes)[0] == '1';
    fake.device[what - 100].scans = 0;
  }
  return (ssize_t)count;
}

int __wrap_access(const char* path, int how) {
  (void)path, (void)how;
  return 0;
}

int __wrap_poll(struct pollfd* fds, nfds_t count, int timeout_ms) {
  const int64_t until_ns = fake.now_ns + timeout_ms * FAKE_MS;
  if (count == 0) {
    pass(until_ns - fake.now_ns);
    return 0;
  }
  enter_call();
  for (;;) {
    int ready = 0;
    if (interrupted()) {
      return fails(EINTR);
    }
    if (active(kPollFails)) {
      return fails(ENOMEM);
    }
    for (nfds_t i = 0; i < count; ++i) {
      const int what = what_is(fds[i].fd);
      if (what < 1 || what > kDeviceCount) {
        misused("polls what is no device");
        return fails(EBADF);
      }
      fds[i].revents = active(kPollTellsError) ? POLLERR : fake.device[what - 1].scans > 0 ? POLLIN : 0;
      ready += fds[i].revents != 0;
    }
    if (ready > 0 || fake.now_ns >= until_ns) {
      return ready;
    }
    pass(FAKE_MS);
  }
}
int __wrap___poll_chk(struct pollfd* fds, nfds_t count, int timeout_ms, size_t room) {
  (void)room;
  return __wrap_poll(fds, count, timeout_ms);
}

DIR* __wrap_opendir(const char* path) {
  (void)path;
  enter_call();
  if (active(kUnplugged)) {
    errno = ENOENT;
    return NULL;
  }
  ++fake.folders;
  fake.entries = 0;
  return (DIR*)(void*)&fake;
}
struct dirent* __wrap_readdir(DIR* folder) {
  static struct dirent entry;
  (void)folder;
  snprintf(entry.d_name, sizeof(entry.d_name), "in_channel%d_en", fake.entries);
  return fake.entries++ < 7 ? &entry : NULL;
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
  pass(1000);
  now->tv_sec = (time_t)(fake.now_ns / FAKE_SECOND + (clock == CLOCK_REALTIME ? 1700000000 : 0));
  now->tv_nsec = (long)(fake.now_ns % FAKE_SECOND);
  return 0;
}

static void begin(uint64_t seed) {
  static const char* const ids[] = {"anglvel_x", "anglvel_y", "anglvel_z", "accel_x",
                                    "accel_y",   "accel_z",   "timestamp"};
  static const char* const devices[] = {"iio:device0", "iio:device1", "trigger0"};
  memset(&fake, 0, sizeof(fake));
  fake.random.state = seed;
  fake.now_ns = 10000 * FAKE_SECOND; /* the clock has run for some hours */
  fake.restored_ns = fake.now_ns;
  fake.next_scan_ns = fake.now_ns + kPeriodNs;
  fake.error = EIO;
  fake.split = fake_random_below(&fake.random, 2);
  fake.real_time = fake_random_below(&fake.random, 3) == 0;
  for (int d = 0; d < kDeviceCount; ++d) {
    struct iio_device* device = &fake.device[d];
    device->id = devices[d];
    device->name = d == 2 ? "unit-trigger" : "unit";
    device->trigger = d == 2;
    device->gyro = d == 0;
    device->accel = fake.split ? d == 1 : d == 0;
    device->timed = fake_random_below(&fake.random, 4) != 0;
    for (int i = 0; i < 7; ++i) {
      struct iio_channel* channel = &device->channel[i];
      channel->id = ids[i];
      channel->index = i;
      channel->format.length = channel->format.bits = i < 6 ? 16 : 64;
      channel->format.is_signed = true;
      channel->format.repeat = 1;
    }
  }
}

static void expect_nothing_left(const char* what) {
  char line[192];
  int open = 0;
  for (int i = 0; i < kFds; ++i) {
    open += fake.open[i] != 0;
  }
  snprintf(line, sizeof(line), "%s: %d files, %d contexts and %d folders left, %s", what, open, fake.contexts,
           fake.folders, fake.misuse != NULL ? fake.misuse : "no misuse");
  TEST_ASSERT_TRUE_MESSAGE(open == 0 && fake.contexts == 0 && fake.folders == 0 && fake.misuse == NULL, line);
}

/* What a program saw that read the unit for a while, and opened it again when it left. */
typedef struct watcher {
  pf_iio_t* imu;
  int64_t last_t_ns, last_sample_ns, longest_stop_ns, samples;
  int failed;
} watcher_t;

static void use_samples(watcher_t* watcher, const pf_imu_sample_t* samples, int count) {
  for (int i = 0; i < count; ++i) {
    watcher->failed |= samples[i].t_ns <= watcher->last_t_ns || samples[i].t_ns > fake.now_ns;
    for (int k = 0; k < 3; ++k) {
      watcher->failed |= !isfinite(samples[i].gyro[k]) || !isfinite(samples[i].accel[k]);
    }
    watcher->last_t_ns = samples[i].t_ns;
  }
  watcher->samples += count;
}

static void note_stop(watcher_t* watcher) {
  const int64_t since_ns = watcher->last_sample_ns > fake.restored_ns ? watcher->last_sample_ns : fake.restored_ns;
  const int64_t stop_ns = fake.now_ns - since_ns;
  watcher->longest_stop_ns = stop_ns > watcher->longest_stop_ns ? stop_ns : watcher->longest_stop_ns;
}

static void watch(watcher_t* watcher, int64_t duration_ns) {
  const int64_t until_ns = fake.now_ns + duration_ns;
  char message[PF_IIO_MESSAGE] = "";
  memset(watcher, 0, sizeof(*watcher));
  watcher->last_sample_ns = fake.now_ns;
  while (fake.now_ns < until_ns && !watcher->failed) {
    pf_imu_sample_t samples[16];
    int count;
    int read;
    if (watcher->imu == NULL) {
      if (pf_iio_open("unit", 0, &watcher->imu, message) == 0 && pf_iio_start(watcher->imu, message) != 0) {
        if (pf_iio_start(watcher->imu, message) != 0) {
          pf_iio_close(watcher->imu);
          watcher->imu = NULL;
        }
      }
      pass(watcher->imu == NULL ? 50 * FAKE_MS : 0);
      note_stop(watcher);
      continue;
    }
    read = pf_iio_read(watcher->imu, 30, samples, 1 + fake_random_below(&fake.random, 16), &count, message);
    note_stop(watcher);
    if (read == PF_IIO_SAMPLES) {
      watcher->last_sample_ns = fake.now_ns;
      use_samples(watcher, samples, count);
    } else if (read == PF_IIO_GONE) {
      if (pf_iio_return(watcher->imu, message) != 0) {
        pass(50 * FAKE_MS);
      }
    } else if (read != PF_IIO_NOTHING) {
      printf("read: %s\n", message);
      watcher->failed = 1;
    }
  }
}

static void test_unit_should_go_on_when_its_driver_fails_in_any_order(void) {
  static const int errors[] = {EIO, EINVAL, ENOMEM, EBUSY};
  int64_t longest_ns = 0;
  int64_t samples = 0;
  int64_t departures = 0;
  for (int sequence = 0; sequence < kSequences; ++sequence) {
    const uint64_t seed = 1000 + (uint64_t)sequence;
    watcher_t watcher;
    pf_iio_info_t info;
    char line[160];
    begin(seed);
    fake.error = errors[fake_random_below(&fake.random, 4)];
    fake.fault_count = 1 + fake_random_below(&fake.random, kMaxFaults);
    for (int i = 0; i < fake.fault_count; ++i) {
      fault_t* fault = &fake.faults[i];
      fault->kind = (fault_kind_t)fake_random_below(&fake.random, kFaultKinds);
      fault->begin_ns = fake.now_ns + fake_random_below(&fake.random, 4000) * FAKE_MS;
      fault->end_ns = fault->begin_ns + (fake_random_below(&fake.random, 3) == 0 ? 6 : 2000) * FAKE_MS;
      fault->at_call = -1;
      if (fault->kind == kUnplugged && fake_random_below(&fake.random, 2) == 0) {
        fault->at_call = fake_random_below(&fake.random, 600);
        fault->begin_ns += 1000 * FAKE_SECOND; /* until that call is reached */
        fault->end_ns += 1000 * FAKE_SECOND;
      }
    }
    watch(&watcher, 7 * FAKE_SECOND);
    memset(&info, 0, sizeof(info));
    if (watcher.imu != NULL) {
      pf_iio_get_info(watcher.imu, &info);
    }
    pf_iio_close(watcher.imu);
    snprintf(line, sizeof(line), "seed %llu: %lld samples, longest stop %.3f s, %lld departures",
             (unsigned long long)seed, (long long)watcher.samples, 1e-9 * (double)watcher.longest_stop_ns,
             (long long)info.departures);
    TEST_ASSERT_FALSE_MESSAGE(watcher.failed, line);
    TEST_ASSERT_TRUE_MESSAGE(watcher.longest_stop_ns <= kLongestStopNs, line);
    expect_nothing_left(line);
    longest_ns = watcher.longest_stop_ns > longest_ns ? watcher.longest_stop_ns : longest_ns;
    samples += watcher.samples;
    departures += info.departures;
  }
  printf("%d sequences from seed 1000: %lld samples, %lld departures, longest stop %.3f s\n", kSequences,
         (long long)samples, (long long)departures, 1e-9 * (double)longest_ns);
  TEST_ASSERT_TRUE(departures > 0);
}

static int64_t samples_with(fault_kind_t kind) {
  watcher_t watcher;
  begin(7);
  fake.fault_count = 1;
  fake.faults[0].kind = kind;
  fake.faults[0].begin_ns = fake.now_ns + 500 * FAKE_MS;
  fake.faults[0].end_ns = fake.faults[0].begin_ns + 6 * FAKE_MS;
  fake.faults[0].at_call = -1;
  for (int d = 0; d < kDeviceCount; ++d) {
    fake.device[d].timed = 1;
  }
  watch(&watcher, 5 * FAKE_SECOND);
  pf_iio_close(watcher.imu);
  TEST_ASSERT_FALSE(watcher.failed);
  expect_nothing_left("one fault");
  return watcher.samples;
}

static void test_unit_should_go_on_when_one_time_lies_an_hour_ahead_or_behind(void) {
  TEST_ASSERT_GREATER_OR_EQUAL_INT(985, samples_with(kStampsAhead));
  TEST_ASSERT_GREATER_OR_EQUAL_INT(985, samples_with(kStampsBehind));
}

static void test_unit_should_go_on_when_one_read_failed(void) {
  TEST_ASSERT_GREATER_OR_EQUAL_INT(950, samples_with(kReadFails));
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_unit_should_go_on_when_one_time_lies_an_hour_ahead_or_behind);
  RUN_TEST(test_unit_should_go_on_when_one_read_failed);
  RUN_TEST(test_unit_should_go_on_when_its_driver_fails_in_any_order);
  return UNITY_END();
}
