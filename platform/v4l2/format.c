#include <stdio.h>
#include <string.h>

#include "device.h"

static const struct {
  uint32_t fourcc;
  const char* name;
} kFormats[PF_V4L2_FORMATS] = {
    [PF_V4L2_ANY] = {0, "any"},
    [PF_V4L2_GREY] = {V4L2_PIX_FMT_GREY, "GREY"},
    [PF_V4L2_NV12] = {V4L2_PIX_FMT_NV12, "NV12"},
    [PF_V4L2_YUYV] = {V4L2_PIX_FMT_YUYV, "YUYV"},
    [PF_V4L2_Y16] = {V4L2_PIX_FMT_Y16, "Y16"},
    [PF_V4L2_MJPEG] = {V4L2_PIX_FMT_MJPEG, "MJPEG"},
};

uint32_t pf_v4l2_fourcc(uint32_t format) { return format < PF_V4L2_FORMATS ? kFormats[format].fourcc : 0; }

const char* pf_v4l2_format_name(uint32_t format) { return format < PF_V4L2_FORMATS ? kFormats[format].name : NULL; }

static int set_format(int fd, uint32_t fourcc, const pf_v4l2_options_t* options, unsigned long request,
                      struct v4l2_format* format) {
  memset(format, 0, sizeof(*format));
  format->type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  format->fmt.pix.width = (uint32_t)options->width;
  format->fmt.pix.height = (uint32_t)options->height;
  format->fmt.pix.pixelformat = fourcc;
  format->fmt.pix.field = V4L2_FIELD_NONE;
  return pf_v4l2_call(fd, request, format);
}

static double seconds(const struct v4l2_fract* interval) {
  return interval->denominator > 0 ? (double)interval->numerator / (double)interval->denominator : 0.0;
}

/* Highest rate that a format has in a size; 0 where the driver does not say. */
static double fastest(int fd, uint32_t fourcc, const pf_v4l2_options_t* options) {
  double best = 0.0;
  for (uint32_t index = 0; index < 256; ++index) {
    struct v4l2_frmivalenum interval;
    double shortest;
    memset(&interval, 0, sizeof(interval));
    interval.index = index;
    interval.pixel_format = fourcc;
    interval.width = (uint32_t)options->width;
    interval.height = (uint32_t)options->height;
    if (pf_v4l2_call(fd, VIDIOC_ENUM_FRAMEINTERVALS, &interval) != 0) {
      break;
    }
    shortest = seconds(interval.type == V4L2_FRMIVAL_TYPE_DISCRETE ? &interval.discrete : &interval.stepwise.min);
    if (shortest > 0.0 && 1.0 / shortest > best) {
      best = 1.0 / shortest;
    }
    if (interval.type != V4L2_FRMIVAL_TYPE_DISCRETE) {
      break;
    }
  }
  return best;
}

/* The cheapest format that has the size and the rate; failing the rate, the fastest one. ANY: none has the size. */
static uint32_t choose(const pf_v4l2_t* camera, char sizes[PF_V4L2_MESSAGE / 4]) {
  const pf_v4l2_options_t* options = &camera->options;
  uint32_t chosen = PF_V4L2_ANY;
  double chosen_rate = 0.0;
  size_t used = 0;
  sizes[0] = '\0';
  for (uint32_t f = 1; f < PF_V4L2_FORMATS; ++f) {
    struct v4l2_format format;
    double rate;
    if ((camera->info.device.formats & 1u << f) == 0 || (options->format != PF_V4L2_ANY && options->format != f)) {
      continue;
    }
    if (set_format(camera->fd, kFormats[f].fourcc, options, VIDIOC_TRY_FMT, &format) != 0 ||
        format.fmt.pix.pixelformat != kFormats[f].fourcc) {
      continue;
    }
    if (format.fmt.pix.width != (uint32_t)options->width || format.fmt.pix.height != (uint32_t)options->height) {
      if (used < PF_V4L2_MESSAGE / 4 - 40) {
        used += (size_t)snprintf(sizes + used, 40, "%s%s %u x %u", used > 0 ? ", " : "", kFormats[f].name,
                                 format.fmt.pix.width % 100000, format.fmt.pix.height % 100000);
      }
      continue;
    }
    rate = fastest(camera->fd, kFormats[f].fourcc, options);
    if (!(options->rate_hz > 0.0) || rate == 0.0 || rate >= 0.95 * options->rate_hz) {
      return f;
    }
    if (rate > chosen_rate) {
      chosen = f;
      chosen_rate = rate;
    }
  }
  return chosen;
}

static void set_rate(pf_v4l2_t* camera) {
  struct v4l2_streamparm parameters;
  struct v4l2_fract* interval = &parameters.parm.capture.timeperframe;
  memset(&parameters, 0, sizeof(parameters));
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (camera->options.rate_hz > 0.0) {
    interval->numerator = 1000;
    interval->denominator = (uint32_t)(1000.0 * camera->options.rate_hz + 0.5);
    pf_v4l2_call(camera->fd, VIDIOC_S_PARM, &parameters); /* what it granted is asked below */
    memset(&parameters, 0, sizeof(parameters));
    parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  }
  camera->info.rate_hz = 0.0;
  if (pf_v4l2_call(camera->fd, VIDIOC_G_PARM, &parameters) == 0 && seconds(interval) > 0.0) {
    camera->info.rate_hz = 1.0 / seconds(interval);
  }
}

int pf_v4l2_negotiate(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]) {
  const pf_v4l2_options_t* options = &camera->options;
  const pf_v4l2_device_t* device = &camera->info.device;
  char sizes[PF_V4L2_MESSAGE / 4];
  struct v4l2_format format;
  const uint32_t chosen = choose(camera, sizes);
  if (chosen == PF_V4L2_ANY) {
    if (sizes[0] != '\0') {
      return pf_v4l2_refuse(
          message,
          "%s (%s): has no picture of %d x %d; the nearest that it offers: %s. Calibrate it in a size "
          "that it has",
          device->path, device->name, options->width, options->height, sizes);
    }
    return pf_v4l2_refuse(
        message, "%s (%s): does not give %s", device->path, device->name,
        options->format != PF_V4L2_ANY ? kFormats[options->format].name : "GREY, NV12, YUYV, Y16 or MJPEG");
  }
#ifndef PLANEFOLD_HAVE_JPEG
  if (chosen == PF_V4L2_MJPEG) {
    return pf_v4l2_refuse(message, "%s (%s): gives MJPEG only, and this build has no libjpeg", device->path,
                          device->name);
  }
#endif
  if (set_format(camera->fd, kFormats[chosen].fourcc, options, VIDIOC_S_FMT, &format) != 0 ||
      format.fmt.pix.pixelformat != kFormats[chosen].fourcc || format.fmt.pix.width != (uint32_t)options->width ||
      format.fmt.pix.height != (uint32_t)options->height) {
    return pf_v4l2_refuse(message, "%s (%s): refuses %s in %d x %d; does another program use it?", device->path,
                          device->name, kFormats[chosen].name, options->width, options->height);
  }
  if (format.fmt.pix.field == V4L2_FIELD_ALTERNATE || format.fmt.pix.field == V4L2_FIELD_TOP ||
      format.fmt.pix.field == V4L2_FIELD_BOTTOM) {
    return pf_v4l2_refuse(message, "%s (%s): gives half pictures (fields); choose another input of it", device->path,
                          device->name);
  }
  camera->info.width = options->width;
  camera->info.height = options->height;
  camera->info.format = chosen;
  {
    const uint32_t pixel_bytes = chosen == PF_V4L2_YUYV || chosen == PF_V4L2_Y16 ? 2 : 1;
    const uint32_t row = pixel_bytes * (uint32_t)options->width;
    const uint32_t stride = format.fmt.pix.bytesperline > row ? format.fmt.pix.bytesperline : row;
    const uint64_t bytes = (uint64_t)stride * (uint64_t)(options->height - 1) + row; /* at least */
    if (bytes > INT32_MAX) {
      return pf_v4l2_refuse(message, "%s (%s): its driver says that a row has %u bytes, which cannot be true",
                            device->path, device->name, stride);
    }
    camera->bytes_per_line = stride;
    camera->image_bytes = chosen == PF_V4L2_MJPEG ? 4 : (uint32_t)bytes;
  }
  set_rate(camera);
  return 0;
}
