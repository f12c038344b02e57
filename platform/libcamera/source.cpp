#include <planefold_platform/camera_source.h>

#include <cstdio>
#include <cstring>

#include "camera.h"

namespace {

pf_libcamera_t* camera_of(void* context) { return static_cast<pf_libcamera_t*>(context); }

int start(void* context, char* message) { return pf_libcamera_start(camera_of(context), message); }

int read(void* context, int timeout_ms, pf_camera_source_frame_t* frame, char* message) {
  pf_libcamera_frame_t taken{};
  const int result = pf_libcamera_read(camera_of(context), timeout_ms, &taken, message);
  *frame = {};
  frame->buffer = -1;
  switch (result) {
    case PF_LIBCAMERA_FRAME:
      *frame = {taken.image, taken.arrived_ns, taken.lost_before, taken.buffer};
      return PF_CAMERA_SOURCE_FRAME;
    case PF_LIBCAMERA_NOTHING:
      return PF_CAMERA_SOURCE_NOTHING;
    case PF_LIBCAMERA_GONE:
      return PF_CAMERA_SOURCE_GONE;
    default:
      return -1;
  }
}

void release(void* context, const pf_camera_source_frame_t* frame) {
  pf_libcamera_frame_t taken{};
  taken.buffer = frame->buffer;
  pf_libcamera_release(camera_of(context), &taken);
}

int come_back(void* context, char* message) { return pf_libcamera_return(camera_of(context), message); }

void get_info(const void* context, pf_camera_source_info_t* info) {
  static const char* const stamps[] = {"arrival", "buffer", "sensor"};
  pf_libcamera_info_t known{};
  pf_libcamera_get_info(static_cast<const pf_libcamera_t*>(context), &known);
  *info = {};
  info->interface = "libcamera";
  info->format = pf_libcamera_format_name(known.format);
  info->timestamps = stamps[known.stamp <= PF_LIBCAMERA_STAMP_SENSOR ? known.stamp : 0];
  info->version = pf_libcamera_version();
  std::snprintf(info->id, sizeof(info->id), "%s", known.device.id);
  std::snprintf(info->name, sizeof(info->name), "%s", known.device.model);
  info->rate_hz = known.rate_hz;
  info->exposure_s = known.exposure_s;
  info->buffers = known.buffers;
  info->direct = static_cast<int32_t>(known.direct);
  info->frames = known.frames;
  info->lost = known.lost;
  info->damaged = known.damaged;
  info->departures = known.departures;
}

void close(void* context) { pf_libcamera_close(camera_of(context)); }

}  // namespace

int pf_libcamera_open_source(const char* name, const pf_camera_source_options_t* options, pf_camera_source_t* source,
                             char message[PF_CAMERA_SOURCE_MESSAGE]) {
  using pf::libcamera::refuse;
  if (options == nullptr || source == nullptr) {
    return refuse(message, "options or source is null");
  }
  *source = {};
  if (options->focus >= 0) {
    return refuse(
        message, "focus " + std::to_string(options->focus) + ": libcamera has no steps; -1 holds the lens where it is");
  }
  pf_libcamera_options_t wanted;
  pf_libcamera_options_default(&wanted);
  wanted.width = options->width;
  wanted.height = options->height;
  wanted.rate_hz = options->rate_hz;
  wanted.exposure_s = options->exposure_s;
  wanted.lock_focus = options->lock_focus != 0 ? 1 : 0;
  if (options->format != nullptr && options->format[0] != '\0') {
    while (wanted.format < PF_LIBCAMERA_FORMATS &&
           std::strcmp(options->format, pf_libcamera_format_name(wanted.format)) != 0) {
      ++wanted.format;
    }
    if (wanted.format == PF_LIBCAMERA_FORMATS) {
      return refuse(message, std::string("format '") + options->format +
                                 "': is not known here; known are GREY, YUV420, NV12, YUYV, RGB888 and BGR888");
    }
  }
  pf_libcamera_t* camera = nullptr;
  if (pf_libcamera_open(name, &wanted, &camera, message) != 0) {
    return -1;
  }
  *source = {camera, start, read, release, come_back, get_info, close};
  return 0;
}
