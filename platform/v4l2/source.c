#include <planefold_platform/camera_source.h>
#include <stdio.h>
#include <string.h>

#include "device.h"
#include "formats.h"

static int start(void* context, char* message) { return pf_v4l2_start((pf_v4l2_t*)context, message); }

static int read_frame(void* context, int timeout_ms, pf_camera_source_frame_t* frame, char* message) {
  pf_v4l2_frame_t taken;
  const int result = pf_v4l2_read((pf_v4l2_t*)context, timeout_ms, &taken, message);
  memset(frame, 0, sizeof(*frame));
  frame->buffer = -1;
  if (result == PF_V4L2_FRAME) {
    frame->image = taken.image;
    frame->arrived_ns = taken.arrived_ns;
    frame->lost_before = taken.lost_before;
    frame->buffer = taken.buffer;
  }
  return result == PF_V4L2_FRAME     ? PF_CAMERA_SOURCE_FRAME
         : result == PF_V4L2_NOTHING ? PF_CAMERA_SOURCE_NOTHING
         : result == PF_V4L2_GONE    ? PF_CAMERA_SOURCE_GONE
                                     : -1;
}

static void release(void* context, const pf_camera_source_frame_t* frame) {
  pf_v4l2_frame_t taken;
  memset(&taken, 0, sizeof(taken));
  taken.buffer = frame->buffer;
  pf_v4l2_release((pf_v4l2_t*)context, &taken);
}

static int come_back(void* context, char* message) { return pf_v4l2_return((pf_v4l2_t*)context, message); }

static void get_info(const void* context, pf_camera_source_info_t* info) {
  static const char* const stamps[] = {"arrival", "end of exposure", "start of exposure"};
  pf_v4l2_info_t known;
  pf_v4l2_get_info((const pf_v4l2_t*)context, &known);
  memset(info, 0, sizeof(*info));
  info->interface = "v4l2";
  info->format = pf_v4l2_format_name(known.format);
  info->timestamps = stamps[known.stamp <= PF_V4L2_STAMP_START ? known.stamp : 0];
  info->version = "";
  snprintf(info->id, sizeof(info->id), "%s", known.device.path);
  snprintf(info->name, sizeof(info->name), "%s", known.device.name);
  info->rate_hz = known.rate_hz;
  info->exposure_s = known.exposure_s;
  info->buffers = known.buffers;
  info->direct = (int32_t)known.direct;
  info->read_slowness = known.read_slowness;
  info->frames = known.frames;
  info->lost = known.lost;
  info->damaged = known.damaged;
  info->restarts = known.restarts;
  info->departures = known.departures;
}

static void close_camera(void* context) { pf_v4l2_close((pf_v4l2_t*)context); }

int pf_v4l2_open_source(const char* name, const pf_camera_source_options_t* options, pf_camera_source_t* source,
                        char message[PF_CAMERA_SOURCE_MESSAGE]) {
  const pf_camera_source_t mine = {NULL, start, read_frame, release, come_back, get_info, close_camera};
  pf_v4l2_options_t wanted;
  pf_v4l2_t* camera;
  if (options == NULL || source == NULL) {
    return pf_v4l2_refuse(message, "options or source is null");
  }
  memset(source, 0, sizeof(*source));
  pf_v4l2_options_default(&wanted);
  wanted.width = options->width;
  wanted.height = options->height;
  wanted.rate_hz = options->rate_hz;
  wanted.exposure_s = options->exposure_s;
  wanted.lock_focus = options->lock_focus != 0;
  wanted.focus = options->focus;
  wanted.dma_buf = options->dma_buf != 0;
  if (options->format != NULL && options->format[0] != '\0') {
    uint32_t format = 0;
    while (format < PF_V4L2_FORMATS && strcmp(options->format, pf_v4l2_format_name(format)) != 0) {
      ++format;
    }
    if (format == PF_V4L2_FORMATS) {
      char known[256];
      pf_v4l2_name_formats(~0u, known, sizeof(known));
      return pf_v4l2_refuse(message, "format '%s': is not known here; known are %s", options->format, known);
    }
    wanted.format = format;
  }
  if (pf_v4l2_open(name, &wanted, &camera, message) != 0) {
    return -1;
  }
  *source = mine;
  source->context = camera;
  return 0;
}
