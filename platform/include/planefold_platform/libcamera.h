/* Frames of a camera through libcamera: image processors of boards, which V4L2 alone does not set up, and USB cameras.
 *
 *   char message[PF_LIBCAMERA_MESSAGE];
 *   pf_libcamera_options_t options;
 *   pf_libcamera_options_default(&options);      options.width = 640; options.height = 480;
 *   pf_libcamera_t *camera;
 *   if (pf_libcamera_open("0", &options, &camera, message) != 0) puts(message);
 *   pf_libcamera_start(camera, message);
 *   while (pf_libcamera_read(camera, 100, &frame, message) == PF_LIBCAMERA_FRAME) {
 *     pf_push_frame(slam, &frame.image);
 *     pf_libcamera_release(camera, &frame);
 *   }
 *   pf_libcamera_close(camera);
 *
 * Functions that can fail return 0, or -1 with one line of plain text in message that says what is wrong and what to do.
 * A camera belongs to one thread at a time; libcamera runs threads of its own, and allocates while it streams. Its log is
 * silent unless LIBCAMERA_LOG_LEVELS is in the environment.
 */
#ifndef PLANEFOLD_PLATFORM_LIBCAMERA_H
#define PLANEFOLD_PLATFORM_LIBCAMERA_H

#include <planefold/planefold.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PF_LIBCAMERA_MESSAGE 1024
#define PF_LIBCAMERA_MAX_BUFFERS 32

typedef struct pf_libcamera pf_libcamera_t;

typedef enum pf_libcamera_format {
  PF_LIBCAMERA_ANY = 0,    /* the first of these that the camera has in this size */
  PF_LIBCAMERA_GREY = 1,   /* R8 */
  PF_LIBCAMERA_YUV420 = 2, /* this and the next: a plane of 8-bit grey in front */
  PF_LIBCAMERA_NV12 = 3,
  PF_LIBCAMERA_YUYV = 4,
  PF_LIBCAMERA_RGB888 = 5, /* in memory blue, green, red, as libcamera names it; weighted to grey */
  PF_LIBCAMERA_BGR888 = 6, /* in memory red, green, blue; weighted to grey */
  PF_LIBCAMERA_FORMATS = 7
} pf_libcamera_format_t;

typedef struct pf_libcamera_options {
  int32_t width, height; /* [px] */
  uint32_t format;       /* pf_libcamera_format_t. Default any */
  double rate_hz;        /* 0: as the camera has it. Default 0 */
  double exposure_s;     /* > 0: fixed to this; 0: left to the camera. Default 0 */
  uint32_t lock_focus;   /* 1: autofocus off, the lens stays where it is. Default 0 */
  int32_t buffers;       /* to ask for, 2 .. PF_LIBCAMERA_MAX_BUFFERS; the camera may give another number. Default 6 */
  uint32_t direct; /* 1: pixels of formats with a grey plane are the camera's own memory, which is uncached on some
                            boards; 0: copied once. Default 0 */
} pf_libcamera_options_t;

void pf_libcamera_options_default(pf_libcamera_options_t* options);

/* "GREY" and so on, "any" for 0; null for what is none. */
const char* pf_libcamera_format_name(uint32_t format);

typedef struct pf_libcamera_device {
  char id[256];     /* as libcamera calls it; stays the same when the camera leaves and returns */
  char model[64];   /* of the sensor; empty where nobody says */
  uint32_t formats; /* bit 1 << f for every pf_libcamera_format_t f that it has; 0 while another program uses it */
} pf_libcamera_device_t;

/* Cameras of this machine, in libcamera's order: the first is "0" for pf_libcamera_open. Gives how many there are, of which the
 * first capacity are written. */
int pf_libcamera_list(pf_libcamera_device_t* devices, int capacity);

typedef enum pf_libcamera_stamp {
  PF_LIBCAMERA_STAMP_ARRIVAL = 0, /* taken here when the frame came */
  PF_LIBCAMERA_STAMP_BUFFER = 1,  /* the kernel's, mostly when the frame's last pixel had been read out */
  PF_LIBCAMERA_STAMP_SENSOR = 2   /* libcamera's SensorTimestamp: exposure of the first row */
} pf_libcamera_stamp_t;

typedef struct pf_libcamera_info {
  pf_libcamera_device_t device;
  int32_t width, height;
  int32_t stride;    /* between rows of the camera's memory [bytes] */
  uint32_t format;   /* pf_libcamera_format_t */
  double rate_hz;    /* of the frame duration that came with the last frame; 0: the camera does not say */
  double exposure_s; /* that came with the last frame; 0: the camera does not say */
  int32_t buffers;
  uint32_t stamp;     /* pf_libcamera_stamp_t, of the last frame; the clock is CLOCK_MONOTONIC */
  uint32_t direct;    /* 1: pixels are the camera's memory */
  int64_t frames;     /* handed over */
  int64_t lost;       /* by the numbers that the driver gives to frames */
  int64_t damaged;    /* marked so, cut short, or with a time that runs back */
  int64_t departures; /* how often the camera was unplugged */
} pf_libcamera_info_t;

/* libcamera's version, as it writes it: "v0.0.3". */
const char* pf_libcamera_version(void);

/* name: a number in the order of the list, or part of an id or model; null or empty: the first camera. */
int pf_libcamera_open(const char* name, const pf_libcamera_options_t* options, pf_libcamera_t** camera,
                      char message[PF_LIBCAMERA_MESSAGE]);
void pf_libcamera_close(pf_libcamera_t* camera); /* null is welcome; frames are no longer valid */
void pf_libcamera_get_info(const pf_libcamera_t* camera, pf_libcamera_info_t* info);

int pf_libcamera_start(pf_libcamera_t* camera, char message[PF_LIBCAMERA_MESSAGE]);
int pf_libcamera_stop(pf_libcamera_t* camera, char message[PF_LIBCAMERA_MESSAGE]); /* frames are no longer valid */

typedef struct pf_libcamera_frame {
  pf_image_t image;     /* t_ns grows; what it means is info.stamp */
  int64_t arrived_ns;   /* CLOCK_MONOTONIC when libcamera handed the frame over */
  uint32_t sequence;    /* the driver's number */
  uint32_t lost_before; /* frames that the driver numbered and that never came, between the last one and this */
  int32_t buffer;       /* for pf_libcamera_release */
} pf_libcamera_frame_t;

enum { PF_LIBCAMERA_NOTHING = 0, PF_LIBCAMERA_FRAME = 1, PF_LIBCAMERA_GONE = 2 };

/* PF_LIBCAMERA_FRAME, PF_LIBCAMERA_NOTHING after timeout_ms, PF_LIBCAMERA_GONE when the camera was unplugged, or -1. A frame is
 * valid until it is released; as long as it is not, the camera has one buffer less. */
int pf_libcamera_read(pf_libcamera_t* camera, int timeout_ms, pf_libcamera_frame_t* frame,
                      char message[PF_LIBCAMERA_MESSAGE]);
void pf_libcamera_release(pf_libcamera_t* camera, const pf_libcamera_frame_t* frame);

/* After PF_LIBCAMERA_GONE, with every frame released: looks for the camera of the same id, opens it as it was and streams. 0, or
 * -1 while it is not there. */
int pf_libcamera_return(pf_libcamera_t* camera, char message[PF_LIBCAMERA_MESSAGE]);

#ifdef __cplusplus
}
#endif

#endif
