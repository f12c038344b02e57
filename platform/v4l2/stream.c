#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>

#include "device.h"
#include "formats.h"
#include "grey.h"

/* Memory that takes longer to read than this, compared with ordinary memory, is copied once instead of being read many times. */
static const double kSlow = 3.0;

enum {
  kPauseMs = 5,  /* where waiting would return at once without a frame */
  kFaultyMs = 50 /* longest wait for a driver that failed */
};

int pf_v4l2_start(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]) {
  const pf_v4l2_device_t* device;
  int type;
  if (camera == NULL || camera->fd < 0) {
    return pf_v4l2_refuse(message, "no camera is open");
  }
  type = camera->type;
  device = &camera->info.device;
  if (camera->streaming) {
    return 0;
  }
  if (pf_v4l2_map(camera, message) != 0) {
    return -1;
  }
  for (int32_t i = 0; i < camera->info.buffers; ++i) {
    if (pf_v4l2_queue(camera, i) != 0) {
      const int error = errno;
      pf_v4l2_unmap(camera);
      return pf_v4l2_refuse(message, "%s (%s): does not take a buffer (%s)", device->path, device->name,
                            strerror(error));
    }
  }
  if (pf_v4l2_call(camera->fd, VIDIOC_STREAMON, &type) != 0) {
    const int error = errno;
    pf_v4l2_unmap(camera);
    return pf_v4l2_refuse(message, "%s (%s): does not begin to stream (%s)%s", device->path, device->name,
                          strerror(error), error == ENOSPC ? "; the bus has no room, lower size or rate" : "");
  }
  camera->streaming = 1;
  camera->has_sequence = 0;
  camera->hand_over_known = 0;
  camera->fault_ns = 0;
  camera->restarts = 0;
  camera->restart_refused = 0;
  camera->started_ns = pf_v4l2_now_ns();
  camera->start_took_ns = 0;
  return 0;
}

int pf_v4l2_stop(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]) {
  int type, result;
  if (camera == NULL || !camera->streaming) {
    return 0;
  }
  type = camera->type;
  result = pf_v4l2_call(camera->fd, VIDIOC_STREAMOFF, &type);
  camera->streaming = 0;
  pf_v4l2_unmap(camera);
  if (result != 0 && !camera->gone) {
    return pf_v4l2_refuse(message, "%s: does not stop to stream (%s)", camera->info.device.path, strerror(errno));
  }
  return 0;
}

static int depart(pf_v4l2_t* camera, char message[PF_V4L2_MESSAGE]) {
  pf_v4l2_refuse(message, "%s (%s): is gone, or gives no more frames; was it unplugged?", camera->info.device.path,
                 camera->info.device.name);
  if (!camera->gone) {
    camera->gone = 1;
    ++camera->info.departures;
  }
  return PF_V4L2_GONE;
}

/* Frames that are missing in front of this one, by its number. */
static uint32_t count_lost(pf_v4l2_t* camera, uint32_t sequence) {
  const uint32_t step = camera->has_sequence ? sequence - camera->last_sequence : 1;
  camera->has_sequence = 1;
  camera->last_sequence = sequence;
  return step > 1 && step < 0x80000000u ? step - 1 : 0;
}

static void decide_hand_over(pf_v4l2_t* camera, const pf_v4l2_buffer_t* buffer) {
  if (pf_v4l2_format_row(camera->info.format)->layout != PF_LAYOUT_PLANE ||
      camera->options.hand_over == PF_V4L2_COPIED) {
    camera->info.direct = 0;
  } else if (camera->options.hand_over == PF_V4L2_DIRECT) {
    camera->info.direct = 1;
  } else {
    camera->info.read_slowness = pf_v4l2_read_slowness(buffer->mapped, camera->image_bytes);
    camera->info.direct = camera->info.read_slowness < kSlow;
  }
}

/* Bits of the samples: those of the format, or as many as a picture has shown so far. */
static uint32_t learn_bits(pf_v4l2_t* camera, const uint8_t* in, const pf_v4l2_format_row_t* row) {
  if (row->detail != 0) {
    camera->info.bits = row->detail;
  } else if (camera->info.bits < 16) {
    const uint32_t bits = pf_bits_of_samples(in, camera->bytes_per_line, camera->info.width, camera->info.height);
    camera->info.bits = bits > camera->info.bits ? bits : camera->info.bits;
  }
  return camera->info.bits;
}

/* Grey pixels from used bytes in a buffer, as an image; 0, or -1 where it cannot be decoded. */
static int to_image(pf_v4l2_t* camera, const pf_v4l2_buffer_t* buffer, const uint8_t* in, uint32_t used,
                    pf_image_t* image) {
  const pf_v4l2_format_row_t* row = pf_v4l2_format_row(camera->info.format);
  const int32_t width = camera->info.width;
  const int32_t height = camera->info.height;
  const size_t stride = camera->bytes_per_line;
  image->width = width;
  image->height = height;
  image->stride = camera->info.direct ? (int32_t)stride : width;
  image->pixels = camera->info.direct ? in : buffer->own;
  if (camera->info.direct) {
    return 0;
  }
  switch (row->layout) {
    case PF_LAYOUT_PLANE:
      pf_grey_from_grey(in, stride, width, height, buffer->own);
      break;
    case PF_LAYOUT_PAIRS:
      pf_grey_from_pairs(in, stride, width, height, row->detail, buffer->own);
      break;
    case PF_LAYOUT_SAMPLE:
      pf_grey_from_samples(in, stride, width, height, learn_bits(camera, in, row), buffer->own);
      break;
    case PF_LAYOUT_MIPI10:
      pf_grey_from_mipi10(in, stride, width, height, buffer->own);
      break;
    case PF_LAYOUT_JPEG:
      return pf_grey_from_jpeg(in, used, width, height, buffer->own);
  }
  return 0;
}

/* What a filled buffer holds: where its picture begins, and how many bytes it has; null where that cannot be true. */
static const uint8_t* picture_in(const pf_v4l2_t* camera, const pf_v4l2_named_t* taken, uint32_t* used) {
  const int has_planes = camera->type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
  const pf_v4l2_buffer_t* buffer = &camera->buffers[taken->buffer.index];
  const uint32_t end = has_planes ? taken->planes[0].bytesused : taken->buffer.bytesused;
  const uint32_t begin = has_planes ? taken->planes[0].data_offset : 0;
  if (end > buffer->length || begin > end || end - begin < camera->image_bytes) {
    return NULL;
  }
  *used = end - begin;
  return buffer->mapped + begin;
}

/* Nothing came because the driver failed; the pause keeps a driver that always fails from taking the whole processor. */
static int wait_after_fault(pf_v4l2_t* camera, int timeout_ms) {
  pf_v4l2_note_fault(camera);
  poll(NULL, 0, timeout_ms < kPauseMs ? timeout_ms : kPauseMs);
  return PF_V4L2_NOTHING;
}

/* Takes the next filled buffer, if there is one. */
static int take(pf_v4l2_t* camera, int timeout_ms, pf_v4l2_frame_t* frame, char message[PF_V4L2_MESSAGE]) {
  pf_v4l2_named_t named;
  const struct v4l2_buffer* taken = &named.buffer;
  pf_v4l2_buffer_t* buffer;
  const uint8_t* picture;
  uint32_t lost, used = 0;
  pf_v4l2_name_buffer(camera, 0, &named);
  if (pf_v4l2_call(camera->fd, VIDIOC_DQBUF, &named.buffer) != 0) {
    if (errno == EAGAIN) {
      return PF_V4L2_NOTHING;
    }
    if (errno == ENODEV || errno == ENXIO) {
      return depart(camera, message);
    }
    camera->info.damaged += errno == EIO; /* a frame that the driver cannot hand over marked as damaged */
    return wait_after_fault(camera, timeout_ms);
  }
  if (taken->index >= (uint32_t)camera->info.buffers || camera->buffers[taken->index].held) {
    ++camera->info.damaged; /* a buffer that the driver does not have */
    return wait_after_fault(camera, timeout_ms);
  }
  buffer = &camera->buffers[taken->index];
  frame->arrived_ns = pf_v4l2_now_ns();
  camera->alive_ns = frame->arrived_ns;
  camera->restarts = 0;
  camera->restart_refused = 0;
  if (camera->start_took_ns == 0) {
    camera->start_took_ns = frame->arrived_ns - camera->started_ns;
  }
  frame->buffer = (int32_t)taken->index;
  frame->sequence = taken->sequence;
  lost = count_lost(camera, taken->sequence);
  camera->info.lost += lost;
  frame->lost_before = lost;
  pf_v4l2_sync(buffer, 1);
  if (!camera->hand_over_known) {
    decide_hand_over(camera, buffer);
    camera->hand_over_known = 1;
  }
  picture = picture_in(camera, &named, &used);
  if ((taken->flags & V4L2_BUF_FLAG_ERROR) != 0 || picture == NULL ||
      pf_v4l2_stamp(camera, taken, frame->arrived_ns, &frame->image.t_ns) != 0 ||
      to_image(camera, buffer, picture, used, &frame->image) != 0) {
    ++camera->info.damaged;
    pf_v4l2_sync(buffer, 0);
    pf_v4l2_queue(camera, frame->buffer); /* what the driver refuses is tried again at the next read */
    return PF_V4L2_NOTHING;
  }
  if (!camera->info.direct) {
    pf_v4l2_sync(buffer, 0);
  }
  pf_keep_stamp(&camera->stamps, frame->image.t_ns, frame->arrived_ns);
  buffer->held = 1;
  ++camera->info.frames;
  return PF_V4L2_FRAME;
}

/* What the caller sees of a frame that was not taken. */
static int nothing(pf_v4l2_frame_t* frame, int result) {
  if (result != PF_V4L2_FRAME) {
    memset(frame, 0, sizeof(*frame));
    frame->buffer = -1;
  }
  return result;
}

int pf_v4l2_read(pf_v4l2_t* camera, int timeout_ms, pf_v4l2_frame_t* frame, char message[PF_V4L2_MESSAGE]) {
  struct pollfd wait;
  int ready;
  if (camera == NULL || frame == NULL) {
    return pf_v4l2_refuse(message, "camera or frame is null");
  }
  memset(frame, 0, sizeof(*frame));
  frame->buffer = -1;
  if (camera->gone) {
    return depart(camera, message);
  }
  if (!camera->streaming) {
    return pf_v4l2_refuse(message, "%s: does not stream; call pf_v4l2_start first", camera->info.device.path);
  }
  if (pf_v4l2_recover(camera) != 0) {
    return depart(camera, message);
  }
  if (camera->fault_ns != 0 && timeout_ms > kFaultyMs) {
    timeout_ms = kFaultyMs; /* so that recovering is not delayed */
  }
  wait.fd = camera->fd;
  wait.events = POLLIN;
  wait.revents = 0;
  ready = poll(&wait, 1, timeout_ms);
  if (ready < 0) {
    return errno == EINTR ? PF_V4L2_NOTHING : wait_after_fault(camera, timeout_ms);
  }
  if (ready == 0) {
    return PF_V4L2_NOTHING;
  }
  if ((wait.revents & POLLHUP) != 0) {
    return depart(camera, message);
  }
  /* POLLERR also says that every buffer is held by the caller: the driver's answer tells these apart. */
  if ((wait.revents & POLLIN) == 0) {
    struct v4l2_capability alive;
    int32_t held = 0;
    if (pf_v4l2_call(camera->fd, VIDIOC_QUERYCAP, &alive) != 0) {
      return depart(camera, message);
    }
    for (int32_t i = 0; i < camera->info.buffers; ++i) {
      held += camera->buffers[i].held;
    }
    if (held < camera->info.buffers) {
      return wait_after_fault(camera, timeout_ms);
    }
    poll(NULL, 0, timeout_ms < kPauseMs ? timeout_ms : kPauseMs);
    return PF_V4L2_NOTHING;
  }
  return nothing(frame, take(camera, timeout_ms, frame, message));
}

void pf_v4l2_release(pf_v4l2_t* camera, const pf_v4l2_frame_t* frame) {
  pf_v4l2_buffer_t* buffer;
  if (camera == NULL || frame == NULL || frame->buffer < 0 || frame->buffer >= camera->info.buffers ||
      !camera->buffers[frame->buffer].held) {
    return;
  }
  buffer = &camera->buffers[frame->buffer];
  buffer->held = 0;
  if (camera->info.direct) {
    pf_v4l2_sync(buffer, 0);
  }
  if (!camera->gone && camera->streaming) {
    pf_v4l2_queue(camera, frame->buffer); /* a camera that left meanwhile says so at the next read */
  }
}
