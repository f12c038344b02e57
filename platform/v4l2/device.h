/* What the files of this room share: the camera, and calls of its driver. For users: lib/docs/guide/capture.md. */
#ifndef PLANEFOLD_PLATFORM_V4L2_DEVICE_H
#define PLANEFOLD_PLATFORM_V4L2_DEVICE_H

#include <linux/videodev2.h>
#include <planefold_platform/stamps.h>
#include <planefold_platform/v4l2.h>

/* A buffer as calls of the driver name it; planes is unused by cameras of the single-planar interface. */
typedef struct pf_v4l2_named {
  struct v4l2_buffer buffer;
  struct v4l2_plane planes[VIDEO_MAX_PLANES];
} pf_v4l2_named_t;

typedef struct pf_v4l2_buffer {
  uint8_t* mapped; /* null: not mapped */
  size_t length;
  int dma_fd;   /* -1: not exported */
  uint8_t* own; /* width * height, for what is converted or copied */
  int held;     /* by the caller */
  int stranded; /* with nobody: the driver refused to take it back */
} pf_v4l2_buffer_t;

struct pf_v4l2 {
  int fd; /* -1: not open */
  int streaming;
  int gone;
  pf_v4l2_options_t options;
  pf_v4l2_info_t info;
  int type;        /* V4L2_BUF_TYPE_VIDEO_CAPTURE or its _MPLANE, in every call */
  uint32_t planes; /* of a buffer, of which the first is the grey one; single-planar: 1 */
  uint32_t bytes_per_line, image_bytes;
  pf_v4l2_buffer_t buffers[PF_V4L2_MAX_BUFFERS];
  uint8_t* own; /* the memory of all buffers[].own */
  int has_sequence;
  uint32_t last_sequence;
  int hand_over_known;               /* info.direct is decided for this stream */
  pf_stamps_t stamps;                /* of the frames that were handed over */
  int64_t fault_ns;                  /* of the driver's first failure since its stream worked; 0: it works */
  int64_t alive_ns;                  /* when a buffer last came, or the stream was last restarted */
  int restarts;                      /* since a buffer last came */
  int restart_refused;               /* by the driver, the last one */
  int64_t started_ns, start_took_ns; /* from the start of the stream to its first buffer; 0: none came yet */
};

/* ioctl that goes on after a signal. */
int pf_v4l2_call(int fd, unsigned long request, void* argument);

/* One line for message, as printf; returns -1. */
int pf_v4l2_refuse(char message[PF_V4L2_MESSAGE], const char* form, ...) __attribute__((format(printf, 2, 3)));

int64_t pf_v4l2_now_ns(void);

/* Fills in a device from an open node; its buffer type, or -1 where it is no camera. */
int pf_v4l2_describe(int fd, const char* path, pf_v4l2_device_t* device);

/* For a call that names buffer number index, or any buffer. named stays where it is: it points into itself. */
void pf_v4l2_name_buffer(const pf_v4l2_t* camera, uint32_t index, pf_v4l2_named_t* named);

/* One line on why a node could not be opened, and which group or rule would help. */
int pf_v4l2_refuse_open(char message[PF_V4L2_MESSAGE], const char* path, int error);

/* Chooses and sets size, format and rate, then exposure and focus. Nothing streams yet. */
int pf_v4l2_negotiate(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]);
int pf_v4l2_set_controls(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]);

/* Maps and queues the buffers; and the reverse, which never fails. */
int pf_v4l2_map(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]);
void pf_v4l2_unmap(pf_v4l2_t* camera);

/* Gives a buffer to the driver. 0, or -1 with errno, and then the buffer is stranded. */
int pf_v4l2_queue(pf_v4l2_t* camera, int32_t index);

/* Notes that the driver failed; pf_v4l2_recover acts on it. */
void pf_v4l2_note_fault(pf_v4l2_t* camera);

/* After a failure: queues stranded buffers again, and restarts a stream that stays silent. 0, or -1 where the camera has to be
 * opened anew. */
int pf_v4l2_recover(pf_v4l2_t* camera);

/* Time of a frame: the driver's where it can be true, otherwise that of its arrival. It grows from frame to frame. 0, or -1 where
 * the frame has to be dropped. */
int pf_v4l2_stamp(pf_v4l2_t* camera, const struct v4l2_buffer* taken, int64_t arrived_ns, int64_t* t_ns);

/* Tells the kernel that the processor begins or ends reading an exported buffer. */
void pf_v4l2_sync(const pf_v4l2_buffer_t* buffer, int begin);

/* How many times longer it takes to read these bytes than as many of ordinary memory. */
double pf_v4l2_read_slowness(const uint8_t* mapped, size_t bytes);

#endif
