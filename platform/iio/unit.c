#include "unit.h"

#include <errno.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { kNapMs = 20 };

/* A unit that is there and gives nothing is opened anew no more often than this. */
static const int64_t kReturnPauseNs = 200000000;

int pf_iio_refuse(char message[PF_IIO_MESSAGE], const char* form, ...) {
  if (message != NULL) {
    va_list arguments;
    va_start(arguments, form);
    vsnprintf(message, PF_IIO_MESSAGE, form, arguments);
    va_end(arguments);
  }
  return -1;
}

static void stop(pf_iio_t* imu) {
  for (int p = 0; p < imu->parts; ++p) {
    pf_iio_buffer_close(&imu->part[p].buffer);
  }
}

static void let_go(pf_iio_t* imu) {
  stop(imu);
  if (imu->context != NULL) {
    iio_context_destroy(imu->context);
    imu->context = NULL;
  }
  imu->parts = 0;
}

/* Opens the context and chooses the devices. */
static int find_unit(pf_iio_t* imu, char message[PF_IIO_MESSAGE]) {
  imu->context = iio_create_local_context();
  if (imu->context == NULL) {
    return pf_iio_refuse(message, "iio:%s: this machine has no IIO device (%s); pf-capture --list names what there is",
                         imu->name, strerror(errno));
  }
  if (pf_iio_choose(imu, message) != 0) {
    let_go(imu);
    return -1;
  }
  for (int p = 0; p < imu->parts; ++p) {
    for (int kind = 0; kind < PF_IIO_KINDS; ++kind) {
      if (imu->part[p].sensor[kind].axis[0] != NULL) {
        pf_iio_read_sensor(imu, &imu->part[p], kind);
      }
    }
  }
  return 0;
}

int pf_iio_open(const char* name, double rate_hz, pf_iio_t** imu, char message[PF_IIO_MESSAGE]) {
  pf_iio_t* opened;
  if (imu == NULL) {
    return pf_iio_refuse(message, "imu is null");
  }
  *imu = NULL;
  if (name != NULL && strlen(name) >= sizeof(opened->name)) {
    return pf_iio_refuse(message, "iio: a name of %zu letters is too long", strlen(name));
  }
  opened = (pf_iio_t*)calloc(1, sizeof(*opened));
  if (opened == NULL) {
    return pf_iio_refuse(message, "iio: no memory");
  }
  snprintf(opened->name, sizeof(opened->name), "%s", name != NULL ? name : "");
  opened->rate_hz = rate_hz;
  if (find_unit(opened, message) != 0) {
    free(opened);
    return -1;
  }
  *imu = opened;
  return 0;
}

void pf_iio_close(pf_iio_t* imu) {
  if (imu != NULL) {
    let_go(imu);
    free(imu);
  }
}

void pf_iio_get_info(const pf_iio_t* imu, pf_iio_info_t* info) { *info = imu->info; }

/* The kernel's times on the clock of the cameras, where the driver lets them be. */
static uint32_t choose_clock(pf_iio_part_t* part) {
  char clock[64] = "";
  part->time = iio_device_find_channel(part->device, "timestamp", false);
  if (part->time == NULL) {
    return PF_IIO_STAMP_ARRIVAL;
  }
  (void)!iio_device_attr_write(part->device, "current_timestamp_clock", "monotonic");
  (void)!iio_device_attr_read(part->device, "current_timestamp_clock", clock, sizeof(clock));
  part->real_time = strncmp(clock, "realtime", 8) == 0;
  if (strncmp(clock, "monotonic", 9) == 0 && clock[9] != '_') {
    return PF_IIO_STAMP_MONOTONIC;
  }
  if (part->real_time) {
    return PF_IIO_STAMP_CONVERTED;
  }
  part->time = NULL; /* of a clock that says nothing here */
  return PF_IIO_STAMP_ARRIVAL;
}

/* A device without a trigger gets the one that bears its name. */
static void choose_trigger(pf_iio_t* imu, const struct iio_device* device) {
  const struct iio_device* trigger = NULL;
  const char* name = iio_device_get_name(device);
  if (iio_device_get_trigger(device, &trigger) == 0 && trigger != NULL) {
    return;
  }
  for (unsigned i = 0; name != NULL && i < iio_context_get_devices_count(imu->context); ++i) {
    const struct iio_device* other = iio_context_get_device(imu->context, i);
    const char* its = iio_device_get_name(other);
    if (iio_device_is_trigger(other) && its != NULL && strncmp(its, name, strlen(name)) == 0 &&
        iio_device_set_trigger(device, other) == 0) {
      return;
    }
  }
}

static int start_part(pf_iio_t* imu, pf_iio_part_t* part, char message[PF_IIO_MESSAGE]) {
  const pf_iio_device_t* described = part == &imu->part[0] ? &imu->info.gyro : &imu->info.accel;
  const uint32_t stamp = choose_clock(part);
  const struct iio_channel* channels[PF_IIO_CHANNELS];
  int count = 0;
  int status;
  if (imu->info.stamp == PF_IIO_STAMP_MONOTONIC || stamp == PF_IIO_STAMP_ARRIVAL) {
    imu->info.stamp = stamp; /* the worse of both */
  }
  for (int kind = 0; kind < PF_IIO_KINDS; ++kind) {
    for (int i = 0; i < 3 && part->sensor[kind].axis[i] != NULL; ++i) {
      channels[count++] = part->sensor[kind].axis[i];
    }
  }
  if (part->time != NULL) {
    channels[count++] = part->time;
  }
  choose_trigger(imu, part->device);
  status = pf_iio_buffer_open(&part->buffer, part->device, channels, count);
  if (status == -EACCES || status == -EPERM) {
    return pf_iio_refuse(message, "iio:%s (%s): this user may not read it; %s", described->name, described->id,
                         pf_iio_permission_hint());
  }
  if (status == -EBUSY) {
    return pf_iio_refuse(message, "iio:%s (%s): in use by another program; stop it (iio-sensor-proxy may be the one)",
                         described->name, described->id);
  }
  if (status != 0) {
    return pf_iio_refuse(message, "iio:%s (%s): does not stream (%s); it may need a trigger", described->name,
                         described->id, strerror(-status));
  }
  part->started_ns = part->last_read_ns = pf_iio_clock_ns(0);
  memset(&part->stamps, 0, sizeof(part->stamps));
  pf_keep_stamp(&part->stamps, imu->has_last ? imu->last_t_ns : 0, part->started_ns);
  return 0;
}

int pf_iio_start(pf_iio_t* imu, char message[PF_IIO_MESSAGE]) {
  stop(imu); /* where it streams already */
  imu->info.stamp = PF_IIO_STAMP_MONOTONIC;
  /* Accelerations first, so that there is one before the first rate. */
  for (int p = imu->parts - 1; p >= 0; --p) {
    if (start_part(imu, &imu->part[p], message) != 0) {
      stop(imu);
      return -1;
    }
  }
  for (int kind = 0; kind < PF_IIO_KINDS; ++kind) {
    imu->queue[kind].begin = imu->queue[kind].count = 0;
  }
  imu->gone = 0;
  imu->started_ns = pf_iio_clock_ns(0);
  imu->samples_at_start = imu->info.samples;
  return 0;
}

/* Whatever the driver's error is, the cure is the same: the unit is opened anew. */
static int depart(pf_iio_t* imu, int part, int error, char message[PF_IIO_MESSAGE]) {
  imu->gone = 1;
  ++imu->info.departures;
  pf_iio_refuse(message, "iio:%s is gone, or gives no more samples (%s).",
                part == 0 ? imu->info.gyro.name : imu->info.accel.name, strerror(error));
  return PF_IIO_GONE;
}

int pf_iio_read(pf_iio_t* imu, int timeout_ms, pf_imu_sample_t* samples, int capacity, int* count,
                char message[PF_IIO_MESSAGE]) {
  const int64_t until_ns = pf_iio_clock_ns(0) + (int64_t)timeout_ms * 1000000;
  *count = 0;
  if (imu->gone || imu->parts == 0) {
    return PF_IIO_GONE;
  }
  for (;;) {
    struct pollfd wait[2];
    for (int p = 0; p < imu->parts; ++p) {
      const int fetched = pf_iio_fetch(imu, &imu->part[p]);
      if (fetched < 0) {
        return depart(imu, p, -fetched, message);
      }
    }
    *count = pf_iio_join(imu, samples, capacity);
    if (*count > 0) {
      return PF_IIO_SAMPLES;
    }
    if (pf_iio_clock_ns(0) >= until_ns) {
      return PF_IIO_NOTHING;
    }
    /* In short naps: the kernel does not wake a reader when the device leaves. */
    for (int p = 0; p < imu->parts; ++p) {
      wait[p].fd = imu->part[p].buffer.fd;
      wait[p].events = POLLIN;
      wait[p].revents = 0;
    }
    if (poll(wait, (nfds_t)imu->parts, kNapMs) < 0 && errno != EINTR) {
      poll(NULL, 0, kNapMs); /* a wait that fails at once must not take the whole processor */
    }
    for (int p = 0; p < imu->parts; ++p) {
      if ((wait[p].revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) {
        return depart(imu, p, EIO, message);
      }
    }
  }
}

int pf_iio_return(pf_iio_t* imu, char message[PF_IIO_MESSAGE]) {
  const pf_iio_info_t before = imu->info;
  if (imu->info.samples == imu->samples_at_start && pf_iio_clock_ns(0) - imu->started_ns < kReturnPauseNs) {
    return pf_iio_refuse(message, "iio:%s: gave nothing since it was opened; it will be tried again", imu->name);
  }
  let_go(imu);
  imu->gone = 1;
  if (find_unit(imu, message) != 0 || pf_iio_start(imu, message) != 0) {
    let_go(imu);
    imu->info.departures = before.departures;
    return -1;
  }
  return 0;
}
