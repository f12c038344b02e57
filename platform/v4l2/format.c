#include <stdio.h>
#include <string.h>

#include "device.h"
#include "formats.h"

/* Size and format as the driver grants them. */
typedef struct granted {
  uint32_t fourcc, width, height, field, bytes_per_line, planes;
} granted_t;

/* Tries or sets a format. 0, or -1 where the driver does not grant this very one; the size may then be another all the same. */
static int ask(const pf_v4l2_t* camera, uint32_t fourcc, unsigned long request, granted_t* granted) {
  const uint32_t width = (uint32_t)camera->options.width, height = (uint32_t)camera->options.height;
  struct v4l2_format format;
  memset(&format, 0, sizeof(format));
  format.type = (uint32_t)camera->type;
  if (camera->type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE) {
    struct v4l2_pix_format_mplane* pixels = &format.fmt.pix_mp;
    pixels->width = width;
    pixels->height = height;
    pixels->pixelformat = fourcc;
    pixels->field = V4L2_FIELD_NONE;
    if (pf_v4l2_call(camera->fd, request, &format) != 0 || pixels->num_planes < 1 ||
        pixels->num_planes > VIDEO_MAX_PLANES) {
      return -1;
    }
    *granted = (granted_t){
        pixels->pixelformat, pixels->width, pixels->height, pixels->field, pixels->plane_fmt[0].bytesperline,
        pixels->num_planes};
  } else {
    struct v4l2_pix_format* pixels = &format.fmt.pix;
    pixels->width = width;
    pixels->height = height;
    pixels->pixelformat = fourcc;
    pixels->field = V4L2_FIELD_NONE;
    if (pf_v4l2_call(camera->fd, request, &format) != 0) {
      return -1;
    }
    *granted = (granted_t){pixels->pixelformat, pixels->width, pixels->height, pixels->field, pixels->bytesperline, 1};
  }
  return granted->fourcc == fourcc ? 0 : -1;
}

/* The same for whichever of its names the driver knows a format by; fourcc is that name. */
static int try_format(const pf_v4l2_t* camera, uint32_t format, uint32_t* fourcc, granted_t* granted) {
  const pf_v4l2_format_row_t* row = pf_v4l2_format_row(format);
  for (int i = 0; i < PF_FOURCCS; ++i) {
    if (row->fourccs[i] != 0 && ask(camera, row->fourccs[i], VIDIOC_TRY_FMT, granted) == 0) {
      *fourcc = row->fourccs[i];
      return 0;
    }
  }
  return -1;
}

static int has_size(const pf_v4l2_t* camera, const granted_t* granted) {
  return granted->width == (uint32_t)camera->options.width && granted->height == (uint32_t)camera->options.height;
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

/* The cheapest format that has the size and the rate, and the driver's name of it; failing the rate, the fastest one. ANY: none has the
 * size. */
static uint32_t choose(const pf_v4l2_t* camera, uint32_t* fourcc, char sizes[PF_V4L2_MESSAGE / 4]) {
  const pf_v4l2_options_t* options = &camera->options;
  uint32_t chosen = PF_V4L2_ANY, format;
  double chosen_rate = 0.0;
  size_t used = 0;
  sizes[0] = '\0';
  for (uint32_t rank = 0; (format = pf_v4l2_format_by_cost(rank)) != PF_V4L2_ANY; ++rank) {
    granted_t granted;
    uint32_t name;
    double rate;
    if ((camera->info.device.formats & 1u << format) == 0 ||
        (options->format != PF_V4L2_ANY && options->format != format) ||
        try_format(camera, format, &name, &granted) != 0) {
      continue;
    }
    if (!has_size(camera, &granted)) {
      if (used < PF_V4L2_MESSAGE / 4 - 40) {
        used += (size_t)snprintf(sizes + used, 40, "%s%s %u x %u", used > 0 ? ", " : "", pf_v4l2_format_name(format),
                                 granted.width % 100000, granted.height % 100000);
      }
      continue;
    }
    rate = fastest(camera->fd, name, options);
    if (!(options->rate_hz > 0.0) || rate == 0.0 || rate >= 0.95 * options->rate_hz) {
      *fourcc = name;
      return format;
    }
    if (rate > chosen_rate) {
      chosen = format;
      chosen_rate = rate;
      *fourcc = name;
    }
  }
  return chosen;
}

static void set_rate(pf_v4l2_t* camera) {
  struct v4l2_streamparm parameters;
  struct v4l2_fract* interval = &parameters.parm.capture.timeperframe;
  memset(&parameters, 0, sizeof(parameters));
  parameters.type = (uint32_t)camera->type;
  if (camera->options.rate_hz > 0.0) {
    interval->numerator = 1000;
    interval->denominator = (uint32_t)(1000.0 * camera->options.rate_hz + 0.5);
    pf_v4l2_call(camera->fd, VIDIOC_S_PARM, &parameters); /* what it granted is asked below */
    memset(&parameters, 0, sizeof(parameters));
    parameters.type = (uint32_t)camera->type;
  }
  camera->info.rate_hz = 0.0;
  if (pf_v4l2_call(camera->fd, VIDIOC_G_PARM, &parameters) == 0 && seconds(interval) > 0.0) {
    camera->info.rate_hz = 1.0 / seconds(interval);
  }
}

/* Why there is no format: what the camera has, what of it is not read here, and what is. */
static int refuse_formats(const pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]) {
  const pf_v4l2_device_t* device = &camera->info.device;
  const char* wanted = pf_v4l2_format_name(camera->options.format);
  char has[256], known[256];
  pf_v4l2_name_formats(device->formats, has, sizeof(has));
  pf_v4l2_name_formats(~0u, known, sizeof(known));
  if (has[0] != '\0') {
    return pf_v4l2_refuse(message, "%s (%s): does not give %s; it gives %s%s%s", device->path, device->name,
                          camera->options.format != PF_V4L2_ANY ? wanted : "a picture", has,
                          device->others[0] != '\0' ? ", and what is not read here: " : "", device->others);
  }
  if (device->others[0] != '\0') {
    return pf_v4l2_refuse(message, "%s (%s): gives %s only, which is not read here; read are %s", device->path,
                          device->name, device->others, known);
  }
  return pf_v4l2_refuse(message, "%s (%s): names no format of its pictures; is it another node of the same camera?",
                        device->path, device->name);
}

/* Bytes of a row and of a picture. */
static int set_layout(pf_v4l2_t* camera, const granted_t* granted, char message[PF_V4L2_MESSAGE]) {
  const pf_v4l2_device_t* device = &camera->info.device;
  const uint32_t row = pf_v4l2_row_bytes(camera->info.format, camera->info.width);
  const uint32_t stride = granted->bytes_per_line > row ? granted->bytes_per_line : row;
  const uint64_t bytes = (uint64_t)stride * (uint64_t)(camera->info.height - 1) + row; /* at least */
  if (bytes > INT32_MAX) {
    return pf_v4l2_refuse(message, "%s (%s): its driver says that a row has %u bytes, which cannot be true",
                          device->path, device->name, stride);
  }
  camera->planes = granted->planes;
  camera->bytes_per_line = stride;
  camera->image_bytes = camera->info.format == PF_V4L2_MJPEG ? 4 : (uint32_t)bytes;
  return 0;
}

int pf_v4l2_negotiate(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]) {
  const pf_v4l2_options_t* options = &camera->options;
  const pf_v4l2_device_t* device = &camera->info.device;
  char sizes[PF_V4L2_MESSAGE / 4];
  granted_t granted;
  uint32_t fourcc = 0;
  const uint32_t chosen = choose(camera, &fourcc, sizes);
  if (chosen == PF_V4L2_ANY && sizes[0] == '\0') {
    return refuse_formats(camera, message);
  }
  if (chosen == PF_V4L2_ANY) {
    return pf_v4l2_refuse(message,
                          "%s (%s): has no picture of %d x %d; the nearest that it offers: %s. Calibrate it in a size "
                          "that it has",
                          device->path, device->name, options->width, options->height, sizes);
  }
#ifndef PLANEFOLD_HAVE_JPEG
  if (chosen == PF_V4L2_MJPEG) {
    return pf_v4l2_refuse(message, "%s (%s): gives MJPEG only, and this build has no libjpeg", device->path,
                          device->name);
  }
#endif
  if (ask(camera, fourcc, VIDIOC_S_FMT, &granted) != 0 || !has_size(camera, &granted)) {
    return pf_v4l2_refuse(message, "%s (%s): refuses %s in %d x %d; does another program use it?", device->path,
                          device->name, pf_v4l2_format_name(chosen), options->width, options->height);
  }
  if (granted.field == V4L2_FIELD_ALTERNATE || granted.field == V4L2_FIELD_TOP || granted.field == V4L2_FIELD_BOTTOM) {
    return pf_v4l2_refuse(message, "%s (%s): gives half pictures (fields); choose another input of it", device->path,
                          device->name);
  }
  camera->info.width = options->width;
  camera->info.height = options->height;
  camera->info.format = chosen;
  camera->info.bits = 0; /* learned anew */
  if (set_layout(camera, &granted, message) != 0) {
    return -1;
  }
  set_rate(camera);
  return 0;
}
