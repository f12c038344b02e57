#include "buffer.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

int64_t pf_iio_decode(const struct iio_data_format* format, const unsigned char* bytes) {
  const unsigned size = format->length / 8;
  uint64_t value = 0;
  for (unsigned i = 0; i < size; ++i) {
    value |= (uint64_t)bytes[format->is_be ? size - 1 - i : i] << (8 * i);
  }
  value >>= format->shift;
  if (format->bits < 64) {
    const uint64_t sign = UINT64_C(1) << (format->bits - 1);
    value &= (sign << 1) - 1;
    if (format->is_signed && (value & sign) != 0) {
      value |= ~((sign << 1) - 1);
    }
  }
  return (int64_t)value;
}

/* open that goes on after a signal. */
static int open_again(const char* path, int flags) {
  int fd;
  do {
    fd = open(path, flags);
  } while (fd < 0 && errno == EINTR);
  return fd;
}

/* A file below the device in sysfs. 0, or a negative errno. */
static int write_file(const char* device, const char* name, const char* text) {
  char path[256];
  int fd;
  ssize_t written;
  int error;
  snprintf(path, sizeof(path), "/sys/bus/iio/devices/%s/%s", device, name);
  fd = open_again(path, O_WRONLY | O_CLOEXEC);
  if (fd < 0) {
    return -errno;
  }
  do {
    written = write(fd, text, strlen(text));
  } while (written < 0 && errno == EINTR);
  error = errno;
  close(fd);
  return written < 0 ? -error : 0;
}

/* Every channel off, so that what is then switched on is all that a scan holds. */
static int disable_all(const char* device) {
  char path[128];
  DIR* folder;
  struct dirent* entry;
  int status = 0;
  snprintf(path, sizeof(path), "/sys/bus/iio/devices/%s/scan_elements", device);
  folder = opendir(path);
  if (folder == NULL) {
    return -errno;
  }
  while (status == 0 && (entry = readdir(folder)) != NULL) {
    const size_t length = strlen(entry->d_name);
    if (length > 3 && length < 100 && strcmp(entry->d_name + length - 3, "_en") == 0) {
      char name[128];
      snprintf(name, sizeof(name), "scan_elements/%.100s", entry->d_name);
      status = write_file(device, name, "0");
    }
  }
  closedir(folder);
  return status;
}

/* Channels in the order of their index, each at a multiple of its own size, the next scan at one of the largest. */
static int lay_out(pf_iio_buffer_t* buffer, const struct iio_channel* const channels[], int count) {
  unsigned at = 0;
  unsigned largest = 1;
  buffer->channels = 0;
  for (int i = 0; i < count; ++i) {
    int slot = buffer->channels++;
    for (; slot > 0 && iio_channel_get_index(buffer->place[slot - 1].channel) > iio_channel_get_index(channels[i]);
         --slot) {
      buffer->place[slot] = buffer->place[slot - 1];
    }
    buffer->place[slot].channel = channels[i];
  }
  for (int i = 0; i < count; ++i) {
    const struct iio_data_format* format = iio_channel_get_data_format(buffer->place[i].channel);
    const unsigned size = format->length / 8;
    if ((size != 1 && size != 2 && size != 4 && size != 8) || format->bits < 1 || format->repeat > 1 ||
        format->bits + format->shift > format->length) {
      return -EOPNOTSUPP;
    }
    at = (at + size - 1) / size * size;
    buffer->place[i].begin = at;
    at += size;
    largest = size > largest ? size : largest;
  }
  buffer->step = (at + largest - 1) / largest * largest;
  return 0;
}

static int switch_on(pf_iio_buffer_t* buffer) {
  const char* device = buffer->device;
  int status = write_file(device, "buffer/enable", "0");
  if (status == 0) {
    status = disable_all(device);
  }
  for (int i = 0; i < buffer->channels && status == 0; ++i) {
    char name[96];
    snprintf(name, sizeof(name), "scan_elements/in_%.64s_en", iio_channel_get_id(buffer->place[i].channel));
    status = write_file(device, name, "1");
  }
  if (status == 0) {
    (void)write_file(device, "buffer/length", "512"); /* a driver may know better */
    (void)write_file(device, "buffer/watermark", "1");
    status = write_file(device, "buffer/enable", "1");
  }
  return status;
}

int pf_iio_buffer_open(pf_iio_buffer_t* buffer, const struct iio_device* device,
                       const struct iio_channel* const channels[], int count) {
  char path[64];
  int status = lay_out(buffer, channels, count);
  buffer->fd = -1;
  snprintf(buffer->device, sizeof(buffer->device), "%s", iio_device_get_id(device));
  if (status != 0) {
    return status;
  }
  snprintf(path, sizeof(path), "/dev/%s", buffer->device);
  buffer->fd = open_again(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (buffer->fd < 0) {
    return -errno;
  }
  status = switch_on(buffer);
  if (status != 0) {
    pf_iio_buffer_close(buffer);
  }
  return status;
}

void pf_iio_buffer_close(pf_iio_buffer_t* buffer) {
  if (buffer->fd >= 0) {
    (void)write_file(buffer->device, "buffer/enable", "0");
    close(buffer->fd);
    buffer->fd = -1;
  }
}

int pf_iio_buffer_read(pf_iio_buffer_t* buffer) {
  const ssize_t bytes = read(buffer->fd, buffer->bytes, (size_t)PF_IIO_BATCH * buffer->step);
  if (bytes < 0) {
    return errno == EAGAIN || errno == EINTR ? 0 : -errno;
  }
  return (int)((size_t)bytes / buffer->step);
}

int64_t pf_iio_buffer_number(const pf_iio_buffer_t* buffer, int scan, const struct iio_channel* channel) {
  for (int i = 0; i < buffer->channels; ++i) {
    if (buffer->place[i].channel == channel) {
      return pf_iio_decode(iio_channel_get_data_format(channel),
                           buffer->bytes + (size_t)scan * buffer->step + buffer->place[i].begin);
    }
  }
  return 0;
}
