/* A camera behind one interface, whichever module reads it: what a program needs that shows, records or tracks its frames.
 *
 *   pf_camera_source_t camera;
 *   pf_camera_source_options_t options;
 *   pf_camera_source_options_default(&options);     options.width = 640; options.height = 480;
 *   if (pf_v4l2_open_source("/dev/video0", &options, &camera, message) != 0) puts(message);      or pf_libcamera_open_source
 *   camera.start(camera.context, message);
 *   while (camera.read(camera.context, 100, &frame, message) == PF_CAMERA_SOURCE_FRAME) {
 *     pf_push_frame(slam, &frame.image);
 *     camera.release(camera.context, &frame);
 *   }
 *   camera.close(camera.context);
 *
 * Functions that can fail return 0, or -1 with one line of plain text in message (PF_CAMERA_SOURCE_MESSAGE bytes) that says what is wrong
 * and what to do. A camera belongs to one thread at a time.
 */
#ifndef PLANEFOLD_PLATFORM_CAMERA_SOURCE_H
#define PLANEFOLD_PLATFORM_CAMERA_SOURCE_H

#include <planefold/planefold.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PF_CAMERA_SOURCE_MESSAGE 1024

typedef struct pf_camera_source_options {
  int32_t width, height; /* [px] */
  const char* format;    /* "GREY", "NV12" and so on; null or empty: the first that the module prefers. Default null */
  double rate_hz;        /* 0: as the camera has it. Default 0 */
  double exposure_s;     /* > 0: fixed to this; 0: left to the camera. Default 0 */
  int32_t lock_focus;    /* 1: autofocus off. Default 0 */
  int32_t focus;         /* in the driver's own steps, where it has any; negative: where it is. Default -1 */
  int32_t dma_buf;       /* 1: exported buffers, where the module has them. Default 0 */
} pf_camera_source_options_t;

static inline void pf_camera_source_options_default(pf_camera_source_options_t* options) {
  memset(options, 0, sizeof(*options));
  options->focus = -1;
}

typedef struct pf_camera_source_info {
  const char* interface; /* "v4l2" or "libcamera"; this and the next three are constants */
  const char* format;
  const char* timestamps; /* what the time of a frame means: "arrival", "start of exposure" .. */
  const char* version;    /* of the library behind the module, or "" */
  char id[256];           /* what the user calls the camera by */
  char name[64];          /* as its maker calls it */
  double rate_hz;         /* 0: the camera does not say, or not yet */
  double exposure_s;      /* 0: automatic or not known */
  int32_t buffers;
  int32_t direct;       /* 1: pixels are the camera's memory */
  double read_slowness; /* time to read camera memory over that of ordinary memory; 0: not measured */
  int64_t frames, lost, damaged, restarts, departures;
} pf_camera_source_info_t;

typedef struct pf_camera_source_frame {
  pf_image_t image;     /* valid until the frame is released */
  int64_t arrived_ns;   /* CLOCK_MONOTONIC */
  uint32_t lost_before; /* frames that never came, between the last one and this */
  int32_t buffer;       /* for release */
} pf_camera_source_frame_t;

enum { PF_CAMERA_SOURCE_NOTHING = 0, PF_CAMERA_SOURCE_FRAME = 1, PF_CAMERA_SOURCE_GONE = 2 };

typedef struct pf_camera_source {
  void* context;
  int (*start)(void* context, char* message);
  /* PF_CAMERA_SOURCE_FRAME, PF_CAMERA_SOURCE_NOTHING after at most timeout_ms, PF_CAMERA_SOURCE_GONE, or -1. */
  int (*read)(void* context, int timeout_ms, pf_camera_source_frame_t* frame, char* message);
  void (*release)(void* context, const pf_camera_source_frame_t* frame);
  /* After PF_CAMERA_SOURCE_GONE, with every frame released: opens the camera as it was and streams. 0, or -1 while it is not there. */
  int (*come_back)(void* context, char* message);
  void (*get_info)(const void* context, pf_camera_source_info_t* info);
  void (*close)(void* context);
} pf_camera_source_t;

/* A camera of the one module or the other (planefold::platform_v4l2, planefold::platform_libcamera); name is what pf_v4l2_open or
 * pf_libcamera_open takes. On an error the source is all zeros. */
int pf_v4l2_open_source(const char* name, const pf_camera_source_options_t* options, pf_camera_source_t* source,
                        char message[PF_CAMERA_SOURCE_MESSAGE]);
int pf_libcamera_open_source(const char* name, const pf_camera_source_options_t* options, pf_camera_source_t* source,
                             char message[PF_CAMERA_SOURCE_MESSAGE]);

#ifdef __cplusplus
}
#endif

#endif
