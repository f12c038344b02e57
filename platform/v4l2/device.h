/* What the files of this room share: the camera, and calls of its driver. */
#ifndef PLANEFOLD_PLATFORM_V4L2_DEVICE_H
#define PLANEFOLD_PLATFORM_V4L2_DEVICE_H

#include <linux/videodev2.h>
#include <planefold_platform/v4l2.h>

typedef struct pf_v4l2_buffer {
  uint8_t* mapped; /* null: not mapped */
  size_t length;
  int dma_fd;   /* -1: not exported */
  uint8_t* own; /* width * height, for what is converted or copied */
  int held;     /* by the caller */
} pf_v4l2_buffer_t;

struct pf_v4l2 {
  int fd; /* -1: not open */
  int streaming;
  int gone;
  pf_v4l2_options_t options;
  pf_v4l2_info_t info;
  uint32_t bytes_per_line, image_bytes;
  pf_v4l2_buffer_t buffers[PF_V4L2_MAX_BUFFERS];
  uint8_t* own; /* the memory of all buffers[].own */
  int has_sequence;
  uint32_t last_sequence;
  int64_t last_t_ns;
};

/* ioctl that goes on after a signal. */
int pf_v4l2_call(int fd, unsigned long request, void* argument);

/* One line for message, as printf; returns -1. */
int pf_v4l2_refuse(char message[PF_V4L2_MESSAGE], const char* form, ...) __attribute__((format(printf, 2, 3)));

int64_t pf_v4l2_now_ns(void);

/* Fills in a device from an open node; 0, or -1 where it is no camera of the kind that this room knows. */
int pf_v4l2_describe(int fd, const char* path, pf_v4l2_device_t* device);

/* One line on why a node could not be opened, and which group or rule would help. */
int pf_v4l2_refuse_open(char message[PF_V4L2_MESSAGE], const char* path, int error);

uint32_t pf_v4l2_fourcc(uint32_t format);

/* Chooses and sets size, format and rate, then exposure and focus. Nothing streams yet. */
int pf_v4l2_negotiate(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]);
int pf_v4l2_set_controls(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]);

/* Maps and queues the buffers; and the reverse, which never fails. */
int pf_v4l2_map(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]);
void pf_v4l2_unmap(pf_v4l2_t* camera);

/* Tells the kernel that the processor begins or ends reading an exported buffer. */
void pf_v4l2_sync(const pf_v4l2_buffer_t* buffer, int begin);

/* How many times longer it takes to read these bytes than as many of ordinary memory. */
double pf_v4l2_read_slowness(const uint8_t* mapped, size_t bytes);

#endif
