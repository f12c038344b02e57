/* Frames of a camera through the kernel's V4L2 interface.
 *
 *   char message[PF_V4L2_MESSAGE];
 *   pf_v4l2_options_t options;
 *   pf_v4l2_options_default(&options);           options.width = 640; options.height = 480;
 *   pf_v4l2_t *camera;
 *   if (pf_v4l2_open("/dev/video0", &options, &camera, message) != 0) puts(message);
 *   pf_v4l2_start(camera, message);
 *   while (pf_v4l2_read(camera, 100, &frame, message) == PF_V4L2_FRAME) {
 *     pf_push_frame(slam, &frame.image);
 *     pf_v4l2_release(camera, &frame);
 *   }
 *   pf_v4l2_close(camera);
 *
 * Functions that can fail return 0, or -1 with one line of plain text in message that says what is wrong and what to do.
 * A camera belongs to one thread at a time. It uses the heap when it is opened and started, not while it streams.
 * Cameras of the single-planar interface are known, and those of the multi-planar one whose first plane is the grey one.
 */
#ifndef PLANEFOLD_PLATFORM_V4L2_H
#define PLANEFOLD_PLATFORM_V4L2_H

#include <planefold/planefold.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PF_V4L2_MESSAGE 1024
#define PF_V4L2_MAX_BUFFERS 32
#define PF_V4L2_PATH 64

typedef struct pf_v4l2 pf_v4l2_t;

typedef enum pf_v4l2_format {
  PF_V4L2_ANY = 0,  /* the cheapest that the camera has in this size and at this rate: planes, pairs, samples, JPEG */
  PF_V4L2_GREY = 1, /* a plane of 8-bit grey; nothing is converted */
  PF_V4L2_NV12 = 2, /* the same plane, with colour behind it */
  PF_V4L2_YUYV = 3, /* every second byte is grey */
  PF_V4L2_Y16 = 4,  /* samples of 10 to 16 bits in 16: how many, the pictures say (pf_v4l2_info_t.bits) */
  PF_V4L2_MJPEG = 5,
  PF_V4L2_NV21 = 6, /* planes */
  PF_V4L2_NV16 = 7,
  PF_V4L2_NV61 = 8,
  PF_V4L2_YU12 = 9,
  PF_V4L2_YV12 = 10,
  PF_V4L2_422P = 11,
  PF_V4L2_UYVY = 12, /* pairs */
  PF_V4L2_YVYU = 13,
  PF_V4L2_VYUY = 14,
  PF_V4L2_Y10 = 15, /* samples of so many bits in 16 */
  PF_V4L2_Y12 = 16,
  PF_V4L2_Y14 = 17,
  PF_V4L2_Y10P = 18, /* samples of 10 bits, four in five bytes */
  PF_V4L2_FORMATS = 19
} pf_v4l2_format_t;

typedef enum pf_v4l2_hand_over {
  PF_V4L2_MEASURED = 0, /* direct, unless reading the camera's memory was measured to be slow (it may be uncached) */
  PF_V4L2_DIRECT = 1,   /* the pixels of a frame are the camera's own memory */
  PF_V4L2_COPIED = 2
} pf_v4l2_hand_over_t;

typedef struct pf_v4l2_options {
  int32_t width, height; /* [px] */
  uint32_t format;       /* pf_v4l2_format_t. Default any */
  double rate_hz;        /* 0: as the camera has it. Default 0 */
  double exposure_s;     /* > 0: fixed to this; 0: left to the camera. Default 0 */
  uint32_t lock_focus;   /* 1: autofocus off, the lens stays where focus says. Default 0 */
  int32_t focus;         /* in the driver's own steps; negative: where it is. Default -1 */
  int32_t buffers;       /* 2 .. PF_V4L2_MAX_BUFFERS. Default 6 */
  uint32_t dma_buf;      /* 1: buffers are exported, and every access is synchronised with the device. Default 0 */
  uint32_t hand_over;    /* pf_v4l2_hand_over_t. Default measured */
} pf_v4l2_options_t;

void pf_v4l2_options_default(pf_v4l2_options_t* options);

/* "GREY" and so on, "any" for 0; null for what is none. */
const char* pf_v4l2_format_name(uint32_t format);

typedef struct pf_v4l2_device {
  char path[PF_V4L2_PATH]; /* /dev/video0 */
  char name[64];           /* as the driver calls the camera */
  char bus[64];            /* where it is plugged in; stays the same when the camera leaves and returns */
  char driver[32];
  uint32_t formats; /* bit 1 << f for every pf_v4l2_format_t f that it has */
  char others[64];  /* names of what it has and this does not read: "H264, BA81" */
  int32_t refused;  /* 1: there is a node, and this user may not open it; only path is filled in */
} pf_v4l2_device_t;

/* Cameras of this machine, ordered by number. Gives how many there are, of which the first capacity are written. */
int pf_v4l2_list(pf_v4l2_device_t* devices, int capacity);

typedef enum pf_v4l2_stamp {
  PF_V4L2_STAMP_ARRIVAL =
      0,                 /* taken here when the frame came, because the driver's is of another clock or does not grow */
  PF_V4L2_STAMP_END = 1, /* CLOCK_MONOTONIC when the frame's last pixel had been read out */
  PF_V4L2_STAMP_START = 2 /* CLOCK_MONOTONIC when the exposure began */
} pf_v4l2_stamp_t;

typedef struct pf_v4l2_info {
  pf_v4l2_device_t device;
  int32_t width, height;
  uint32_t format; /* pf_v4l2_format_t */
  uint32_t bits;  /* of a sample. Of Y16 10, 12, 14 or 16, as the pictures so far show; the upper 8 of these are kept */
  double rate_hz; /* 0: the driver does not say */
  double exposure_s; /* where it is fixed; 0: automatic or not known */
  int32_t buffers;
  uint32_t stamp;       /* pf_v4l2_stamp_t, known with the first frame */
  uint32_t direct;      /* 1: pixels are the camera's memory; known with the first frame */
  double read_slowness; /* time to read camera memory over that of ordinary memory; 0: not measured */
  int64_t frames;       /* handed over */
  int64_t lost;         /* by the numbers that the driver gives to frames */
  int64_t damaged;      /* marked so by the driver, cut short, not to be decoded, or with a time that runs back */
  int64_t restarts;     /* how often the driver failed and the stream was started again */
  int64_t departures;   /* how often the camera was unplugged, or gave no more frames */
} pf_v4l2_info_t;

/* null path: the first camera that has the size. A path may also be part of a camera's name. */
int pf_v4l2_open(const char* path, const pf_v4l2_options_t* options, pf_v4l2_t** camera, char message[PF_V4L2_MESSAGE]);
void pf_v4l2_close(pf_v4l2_t* camera); /* null is welcome; frames are no longer valid */
void pf_v4l2_get_info(const pf_v4l2_t* camera, pf_v4l2_info_t* info);

int pf_v4l2_start(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]);
int pf_v4l2_stop(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]); /* frames are no longer valid */

typedef struct pf_v4l2_frame {
  pf_image_t image;     /* t_ns grows; what it means is info.stamp */
  int64_t arrived_ns;   /* CLOCK_MONOTONIC when the frame was taken from the driver */
  uint32_t sequence;    /* the driver's number */
  uint32_t lost_before; /* frames that the driver numbered and that never came, between the last one and this */
  int32_t buffer;       /* for pf_v4l2_release */
} pf_v4l2_frame_t;

enum { PF_V4L2_NOTHING = 0, PF_V4L2_FRAME = 1, PF_V4L2_GONE = 2 };

/* PF_V4L2_FRAME, PF_V4L2_NOTHING after at most timeout_ms, PF_V4L2_GONE when the camera was unplugged or gives no more frames, or
 * -1 where nothing streams. A driver that fails is given its buffers again, and its stream is restarted after 0.2 s without one. A
 * frame is valid until it is released; as long as it is not, the camera has one buffer less. */
int pf_v4l2_read(pf_v4l2_t* camera, int timeout_ms, pf_v4l2_frame_t* frame, char message[PF_V4L2_MESSAGE]);
void pf_v4l2_release(pf_v4l2_t* camera, const pf_v4l2_frame_t* frame);

/* After PF_V4L2_GONE, with every frame released: looks for the same camera (by its place, under whatever number), opens it as
 * it was and streams. 0, or -1 while it is not there. */
int pf_v4l2_return(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]);

#ifdef __cplusplus
}
#endif

#endif
