#include <errno.h>

#include "device.h"

/* Without a buffer for so long after a failure, the stream is restarted. */
static const double kPatienceS = 0.2, kPatienceFrames = 3.0;
/* Without one for so long after a restart, it is restarted again; to this comes twice what the first start took. */
static const double kStartS = 0.6;
/* A restart that the driver refuses is tried again after this. */
static const double kRetryS = 0.1;

enum { kMaxRestarts = 8 }; /* without a buffer: the camera is opened anew */

int pf_v4l2_queue(pf_v4l2_t* camera, int32_t index) {
  pf_v4l2_named_t named;
  int result;
  pf_v4l2_name_buffer(camera, (uint32_t)index, &named);
  result = pf_v4l2_call(camera->fd, VIDIOC_QBUF, &named.buffer);
  camera->buffers[index].stranded = result != 0;
  if (result != 0) {
    const int error = errno;
    pf_v4l2_note_fault(camera);
    errno = error;
  }
  return result;
}

void pf_v4l2_note_fault(pf_v4l2_t* camera) {
  if (camera->fault_ns == 0) {
    camera->fault_ns = pf_v4l2_now_ns();
  }
}

/* Number of buffers that stay stranded, or -1 where the camera left. */
static int queue_stranded(pf_v4l2_t* camera) {
  int stranded = 0;
  for (int32_t i = 0; i < camera->info.buffers; ++i) {
    if (camera->buffers[i].stranded && pf_v4l2_queue(camera, i) != 0) {
      if (errno == ENODEV || errno == ENXIO) {
        return -1;
      }
      ++stranded;
    }
  }
  return stranded;
}

/* Off and on again: the driver then has no buffer, and is given all that the caller does not hold. */
static int restart(pf_v4l2_t* camera) {
  int type = camera->type;
  int stranded;
  ++camera->info.restarts;
  ++camera->restarts;
  camera->alive_ns = pf_v4l2_now_ns();
  camera->has_sequence = 0;
  camera->restart_refused = 1;
  if (pf_v4l2_call(camera->fd, VIDIOC_STREAMOFF, &type) != 0) {
    return errno == ENODEV || errno == ENXIO ? -1 : 0;
  }
  for (int32_t i = 0; i < camera->info.buffers; ++i) {
    camera->buffers[i].stranded = !camera->buffers[i].held;
  }
  stranded = queue_stranded(camera);
  if (stranded < 0) {
    return -1;
  }
  if (pf_v4l2_call(camera->fd, VIDIOC_STREAMON, &type) != 0) {
    return errno == ENODEV || errno == ENXIO ? -1 : 0;
  }
  camera->restart_refused = 0;
  return 0;
}

static int64_t patience_ns(const pf_v4l2_t* camera) {
  const double frame_s = camera->info.rate_hz > 0.0 ? 1.0 / camera->info.rate_hz : 0.0;
  const double longest_s = frame_s > camera->info.exposure_s ? frame_s : camera->info.exposure_s;
  double patience_s = kPatienceFrames * longest_s;
  if (camera->restart_refused) {
    return (int64_t)(1e9 * kRetryS);
  }
  patience_s = patience_s > kPatienceS ? patience_s : kPatienceS;
  if (camera->restarts > 0) {
    patience_s += kStartS + 2e-9 * (double)camera->start_took_ns;
  }
  return (int64_t)(1e9 * patience_s);
}

int pf_v4l2_recover(pf_v4l2_t* camera) {
  int32_t held = 0;
  int stranded;
  int64_t since_ns;
  if (camera->fault_ns == 0) {
    return 0;
  }
  for (int32_t i = 0; i < camera->info.buffers; ++i) {
    held += camera->buffers[i].held;
  }
  if (held == camera->info.buffers) { /* it is the caller that keeps frames from coming */
    camera->alive_ns = pf_v4l2_now_ns();
    return 0;
  }
  stranded = queue_stranded(camera);
  if (stranded < 0) {
    return -1;
  }
  if (stranded == 0 && camera->alive_ns > camera->fault_ns && camera->restarts == 0) {
    camera->fault_ns = 0; /* a buffer came after the failure, and none is missing */
    return 0;
  }
  since_ns = camera->alive_ns > camera->fault_ns ? camera->alive_ns : camera->fault_ns;
  if (pf_v4l2_now_ns() - since_ns < patience_ns(camera)) {
    return 0;
  }
  return camera->restarts < kMaxRestarts ? restart(camera) : -1;
}
