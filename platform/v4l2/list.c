#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "device.h"
#include "formats.h"

int pf_v4l2_describe(int fd, const char* path, pf_v4l2_device_t* device) {
  struct v4l2_capability capability;
  uint32_t can;
  int type;
  memset(device, 0, sizeof(*device));
  memset(&capability, 0, sizeof(capability));
  snprintf(device->path, sizeof(device->path), "%s", path);
  if (pf_v4l2_call(fd, VIDIOC_QUERYCAP, &capability) != 0) {
    return -1;
  }
  can = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps : capability.capabilities;
  if ((can & (V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_VIDEO_CAPTURE_MPLANE)) == 0 || (can & V4L2_CAP_STREAMING) == 0) {
    return -1;
  }
  type = (can & V4L2_CAP_VIDEO_CAPTURE) != 0 ? V4L2_BUF_TYPE_VIDEO_CAPTURE : V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
  snprintf(device->name, sizeof(device->name), "%.*s", (int)sizeof(capability.card), (const char*)capability.card);
  snprintf(device->bus, sizeof(device->bus), "%.*s", (int)sizeof(capability.bus_info),
           (const char*)capability.bus_info);
  snprintf(device->driver, sizeof(device->driver), "%.*s", (int)sizeof(capability.driver),
           (const char*)capability.driver);
  for (uint32_t index = 0; index < 256; ++index) {
    struct v4l2_fmtdesc description;
    uint32_t format;
    memset(&description, 0, sizeof(description));
    description.index = index;
    description.type = (uint32_t)type;
    if (pf_v4l2_call(fd, VIDIOC_ENUM_FMT, &description) != 0) {
      break;
    }
    format = pf_v4l2_format_of(description.pixelformat);
    if (format != PF_V4L2_ANY) {
      device->formats |= 1u << format;
    } else {
      pf_v4l2_add_fourcc(device->others, sizeof(device->others), description.pixelformat);
    }
  }
  return type;
}

static int by_number(const void* a, const void* b) {
  const int x = *(const int*)a;
  const int y = *(const int*)b;
  return (x > y) - (x < y);
}

int pf_v4l2_list(pf_v4l2_device_t* devices, int capacity) {
  int numbers[256];
  int nodes = 0;
  int count = 0;
  DIR* folder = opendir("/dev");
  struct dirent* entry;
  if (folder == NULL) {
    return 0;
  }
  while ((entry = readdir(folder)) != NULL && nodes < 256) {
    char* end;
    if (strncmp(entry->d_name, "video", 5) == 0 && entry->d_name[5] >= '0' && entry->d_name[5] <= '9') {
      const long number = strtol(entry->d_name + 5, &end, 10);
      if (*end == '\0' && number < 100000) {
        numbers[nodes++] = (int)number;
      }
    }
  }
  closedir(folder);
  qsort(numbers, (size_t)nodes, sizeof(numbers[0]), by_number);
  for (int i = 0; i < nodes; ++i) {
    pf_v4l2_device_t device;
    char path[PF_V4L2_PATH];
    int fd;
    snprintf(path, sizeof(path), "/dev/video%d", numbers[i]);
    fd = open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (fd >= 0) {
      const int camera = pf_v4l2_describe(fd, path, &device) >= 0;
      close(fd);
      if (!camera) {
        continue;
      }
    } else if (errno == EACCES || errno == EPERM) {
      memset(&device, 0, sizeof(device));
      snprintf(device.path, sizeof(device.path), "%s", path);
      device.refused = 1;
    } else {
      continue;
    }
    if (devices != NULL && count < capacity) {
      devices[count] = device;
    }
    ++count;
  }
  return count;
}
