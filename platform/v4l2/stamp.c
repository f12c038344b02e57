#include "device.h"

/* Frames whose time does not grow are dropped for so long; a driver whose clock stands still or was set back is then no longer
 * believed. */
static const int64_t kPatienceNs = 250000000;

static int64_t by_arrival(pf_v4l2_t* camera, int64_t arrived_ns) {
  camera->info.stamp = PF_V4L2_STAMP_ARRIVAL;
  return arrived_ns;
}

int pf_v4l2_stamp(pf_v4l2_t* camera, const struct v4l2_buffer* taken, int64_t arrived_ns, int64_t* t_ns) {
  const int64_t seconds = (int64_t)taken->timestamp.tv_sec;
  const int64_t arrived_s = arrived_ns / 1000000000;
  const int monotonic = (taken->flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  /* What lies ahead of the clock, or before its beginning, is of another clock. */
  const int possible = monotonic && seconds >= 0 && seconds <= arrived_s;
  const int64_t driver_ns = possible ? seconds * 1000000000 + (int64_t)taken->timestamp.tv_usec * 1000 : 0;
  if (driver_ns > camera->last_t_ns && driver_ns <= arrived_ns) {
    camera->stamps_stale = 0;
    camera->info.stamp = (taken->flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE
                             ? PF_V4L2_STAMP_START
                             : PF_V4L2_STAMP_END;
    *t_ns = driver_ns;
  } else {
    const int backward = driver_ns > 0 && driver_ns <= arrived_ns;
    if (backward && !camera->stamps_stale) {
      if (arrived_ns - camera->last_arrived_ns < kPatienceNs) {
        return -1;
      }
      camera->stamps_stale = 1;
    }
    /* A little ahead, the frame was stamped after the clock was read: still the driver's clock. */
    const int just_now = driver_ns > arrived_ns && driver_ns - arrived_ns < kPatienceNs;
    *t_ns = just_now ? arrived_ns : by_arrival(camera, arrived_ns);
  }
  return *t_ns > camera->last_t_ns ? 0 : -1;
}
