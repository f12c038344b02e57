#include "device.h"

/* The driver's time of its monotonic clock, or 0 where it has none that can be true. */
static int64_t driver_time(const struct v4l2_buffer* taken, int64_t arrived_ns) {
  const int64_t seconds = (int64_t)taken->timestamp.tv_sec;
  if ((taken->flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC || seconds < 0 ||
      seconds > (arrived_ns + PF_STAMP_AHEAD_NS) / 1000000000) {
    return 0;
  }
  return pf_possible_stamp(seconds * 1000000000 + (int64_t)taken->timestamp.tv_usec * 1000, arrived_ns);
}

int pf_v4l2_stamp(pf_v4l2_t* camera, const struct v4l2_buffer* taken, int64_t arrived_ns, int64_t* t_ns) {
  switch (pf_choose_stamp(&camera->stamps, driver_time(taken, arrived_ns), arrived_ns, arrived_ns, t_ns)) {
    case PF_STAMP_DEVICE:
      camera->info.stamp = (taken->flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE
                               ? PF_V4L2_STAMP_START
                               : PF_V4L2_STAMP_END;
      return 0;
    case PF_STAMP_ARRIVAL:
      camera->info.stamp = PF_V4L2_STAMP_ARRIVAL;
      return 0;
    case PF_STAMP_DROP:
      break;
  }
  return -1;
}
