#include "device.h"

/* Frames whose time does not grow are dropped for so long; a driver whose clock stands still or was set back is then no longer
 * believed. */
static const int64_t kPatienceNs = 250000000;

/* A driver may stamp a frame with the end of the readout that is still to come, or a little after the clock was read. */
static const int64_t kAheadNs = 100000000;

static int64_t by_arrival(pf_v4l2_t* camera, int64_t arrived_ns) {
  camera->info.stamp = PF_V4L2_STAMP_ARRIVAL;
  return arrived_ns;
}

/* The driver's time in nanoseconds, or 0 where it is of another clock: far ahead of ours, or before its beginning. */
static int64_t driver_time(const struct v4l2_buffer* taken, int64_t arrived_ns) {
  const int64_t seconds = (int64_t)taken->timestamp.tv_sec;
  const int64_t latest_ns = arrived_ns + kAheadNs;
  int64_t driver_ns;
  if ((taken->flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC || seconds < 0 ||
      seconds > latest_ns / 1000000000) {
    return 0;
  }
  driver_ns = seconds * 1000000000 + (int64_t)taken->timestamp.tv_usec * 1000;
  return driver_ns > 0 && driver_ns <= latest_ns ? driver_ns : 0;
}

int pf_v4l2_stamp(pf_v4l2_t* camera, const struct v4l2_buffer* taken, int64_t arrived_ns, int64_t* t_ns) {
  const int64_t driver_ns = driver_time(taken, arrived_ns);
  if (driver_ns > camera->last_t_ns) {
    camera->stamps_stale = 0;
    camera->info.stamp = (taken->flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE
                             ? PF_V4L2_STAMP_START
                             : PF_V4L2_STAMP_END;
    *t_ns = driver_ns;
  } else {
    if (driver_ns > 0 && !camera->stamps_stale) {
      if (arrived_ns - camera->last_arrived_ns < kPatienceNs) {
        return -1;
      }
      camera->stamps_stale = 1;
    }
    *t_ns = by_arrival(camera, arrived_ns);
  }
  return *t_ns > camera->last_t_ns ? 0 : -1;
}
