#include "device.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

int pf_v4l2_call(int fd, unsigned long request, void* argument) {
  int result;
  do {
    result = ioctl(fd, request, argument);
  } while (result == -1 && errno == EINTR);
  return result;
}

int pf_v4l2_refuse(char message[PF_V4L2_MESSAGE], const char* form, ...) {
  if (message != NULL) {
    va_list arguments;
    va_start(arguments, form);
    vsnprintf(message, PF_V4L2_MESSAGE, form, arguments);
    va_end(arguments);
  }
  return -1;
}

int64_t pf_v4l2_now_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

int pf_v4l2_refuse_open(char message[PF_V4L2_MESSAGE], const char* path, int error) {
  if (error == EACCES || error == EPERM) {
    return pf_v4l2_refuse(message,
                          "%s: this user may not open it; as root: usermod -a -G video USER, then log in again (or a "
                          "udev rule: SUBSYSTEM==\"video4linux\", TAG+=\"uaccess\")",
                          path);
  }
  if (error == ENOENT || error == ENODEV || error == ENXIO) {
    return pf_v4l2_refuse(message, "%s: there is no such camera; pf-capture --list names those that there are", path);
  }
  if (error == EBUSY) {
    return pf_v4l2_refuse(message, "%s: another program uses it; close that first", path);
  }
  return pf_v4l2_refuse(message, "%s: cannot be opened (%s)", path, strerror(error));
}

static int open_node(const char* path) {
  struct stat status;
  if (stat(path, &status) != 0) {
    return -1;
  }
  if (!S_ISCHR(status.st_mode)) {
    errno = ENODEV;
    return -1;
  }
  return open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
}

static int open_as(pf_v4l2_t* camera, const char* path, char message[PF_V4L2_MESSAGE]) {
  pf_v4l2_device_t device;
  camera->fd = open_node(path);
  if (camera->fd < 0) {
    return pf_v4l2_refuse_open(message, path, errno);
  }
  camera->type = pf_v4l2_describe(camera->fd, path, &device);
  if (camera->type < 0) {
    pf_v4l2_refuse(message, "%s: is no camera that gives frames through V4L2; pf-capture --list names those that do",
                   path);
  } else {
    camera->info.device = device;
    if (pf_v4l2_negotiate(camera, message) == 0 && pf_v4l2_set_controls(camera, message) == 0) {
      return 0;
    }
  }
  close(camera->fd);
  camera->fd = -1;
  return -1;
}

/* A path as it is; otherwise, among the cameras there are, one by part of its name or by its place. */
static int open_by_name(pf_v4l2_t* camera, const char* name, const char* bus, char message[PF_V4L2_MESSAGE]) {
  pf_v4l2_device_t devices[16];
  int count = pf_v4l2_list(devices, 16);
  int matches = 0;
  count = count < 16 ? count : 16;
  for (int i = 0; i < count; ++i) {
    const int fits = !devices[i].refused && (bus == NULL || strcmp(devices[i].bus, bus) == 0) &&
                     (name == NULL || strstr(devices[i].name, name) != NULL);
    matches += fits;
    if (fits && open_as(camera, devices[i].path, message) == 0) {
      return 0;
    }
  }
  if (matches > 0) {
    return -1; /* message is that of the last one */
  }
  if (count > 0 && devices[0].refused && name == NULL && bus == NULL) {
    return pf_v4l2_refuse_open(message, devices[0].path, EACCES);
  }
  return name != NULL ? pf_v4l2_refuse(message, "'%s': no camera has a name like this; pf-capture --list", name)
                      : pf_v4l2_refuse(message, "there is no camera; is it plugged in?");
}

int pf_v4l2_open(const char* path, const pf_v4l2_options_t* options, pf_v4l2_t** camera,
                 char message[PF_V4L2_MESSAGE]) {
  pf_v4l2_t* opened;
  int result;
  if (options == NULL || camera == NULL) {
    return pf_v4l2_refuse(message, "options or camera is null");
  }
  *camera = NULL;
  if (options->width < 1 || options->height < 1 || options->width > 16384 || options->height > 16384 ||
      options->format >= PF_V4L2_FORMATS || options->buffers < 2 || options->buffers > PF_V4L2_MAX_BUFFERS ||
      !(options->rate_hz >= 0.0) || options->rate_hz > 10000.0 || !(options->exposure_s >= 0.0) ||
      options->exposure_s > 100.0 || options->hand_over > PF_V4L2_COPIED) {
    return pf_v4l2_refuse(message, "a field of the options is out of its range; v4l2.h says what is possible");
  }
  opened = (pf_v4l2_t*)calloc(1, sizeof(*opened));
  if (opened == NULL) {
    return pf_v4l2_refuse(message, "not enough memory");
  }
  opened->fd = -1;
  opened->options = *options;
  result = path != NULL && path[0] == '/'
               ? open_as(opened, path, message)
               : open_by_name(opened, path != NULL && path[0] != '\0' ? path : NULL, NULL, message);
  if (result != 0) {
    free(opened);
    return -1;
  }
  *camera = opened;
  return 0;
}

static void leave(pf_v4l2_t* camera) {
  if (camera->fd >= 0) {
    if (camera->streaming) {
      int type = camera->type;
      pf_v4l2_call(camera->fd, VIDIOC_STREAMOFF, &type);
      camera->streaming = 0;
    }
    pf_v4l2_unmap(camera);
    close(camera->fd);
    camera->fd = -1;
  }
}

void pf_v4l2_close(pf_v4l2_t* camera) {
  if (camera != NULL) {
    leave(camera);
    free(camera);
  }
}

int pf_v4l2_return(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]) {
  char bus[sizeof(camera->info.device.bus)];
  if (camera == NULL || !camera->gone) {
    return pf_v4l2_refuse(message, "the camera is not gone");
  }
  memcpy(bus, camera->info.device.bus, sizeof(bus));
  leave(camera);
  if (open_by_name(camera, NULL, bus, message) != 0) {
    return -1;
  }
  if (pf_v4l2_start(camera, message) != 0) {
    leave(camera);
    return -1;
  }
  camera->gone = 0;
  return 0;
}

void pf_v4l2_get_info(const pf_v4l2_t* camera, pf_v4l2_info_t* info) {
  if (camera != NULL && info != NULL) {
    *info = camera->info;
  }
}

void pf_v4l2_options_default(pf_v4l2_options_t* options) {
  memset(options, 0, sizeof(*options));
  options->focus = -1;
  options->buffers = 6;
}
