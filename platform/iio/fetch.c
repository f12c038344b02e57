#include <time.h>

#include "unit.h"

int64_t pf_iio_clock_ns(int real_time) {
  struct timespec now;
  clock_gettime(real_time ? CLOCK_REALTIME : CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static void put(pf_iio_t* imu, int kind, const pf_iio_part_t* part, int scan, int64_t t_ns) {
  const pf_iio_sensor_t* sensor = &part->sensor[kind];
  pf_iio_queue_t* queue = &imu->queue[kind];
  pf_iio_reading_t* reading;
  double value[3];
  if (queue->count == PF_IIO_WAITING) {
    queue->begin = (queue->begin + 1) % PF_IIO_WAITING;
    --queue->count;
    ++imu->info.dropped;
  }
  reading = &queue->reading[(queue->begin + queue->count++) % PF_IIO_WAITING];
  reading->t_ns = t_ns;
  for (int i = 0; i < 3; ++i) {
    const double raw = (double)pf_iio_buffer_number(&part->buffer, scan, sensor->axis[i]);
    value[i] = (raw + sensor->offset[i]) * sensor->scale[i];
  }
  for (int i = 0; i < 3; ++i) {
    const double* row = sensor->mount + 3 * i;
    reading->value[i] = row[0] * value[0] + row[1] * value[1] + row[2] * value[2];
  }
}

static const int64_t kSlackNs = 1000000000;

/* Time of a scan: the driver's where it can be true, otherwise that of its arrival. 0, or -1 where the scan has to be dropped. */
static int time_of(pf_iio_part_t* part, int scan, int64_t arrived_ns, int64_t now_ns, int64_t real_ns, int64_t* t_ns) {
  const int64_t clock_ns = part->real_time ? real_ns : now_ns;
  const int64_t number = part->time != NULL ? pf_iio_buffer_number(&part->buffer, scan, part->time) : -1;
  /* A time that lies ahead of the clock, or before the stream, is of another clock. */
  const int64_t shifted_ns = number > 0 && number <= clock_ns ? number + (now_ns - clock_ns) : 0;
  const int64_t driver_ns = shifted_ns >= part->started_ns - kSlackNs ? shifted_ns : 0;
  if (pf_choose_stamp(&part->stamps, driver_ns, arrived_ns, now_ns, t_ns) == PF_STAMP_DROP) {
    return -1;
  }
  pf_keep_stamp(&part->stamps, *t_ns, now_ns);
  return 0;
}

int pf_iio_fetch(pf_iio_t* imu, pf_iio_part_t* part) {
  const int scans = pf_iio_buffer_read(&part->buffer);
  const int64_t now_ns = pf_iio_clock_ns(0);
  const int64_t real_ns = part->real_time ? pf_iio_clock_ns(1) : now_ns;
  const int64_t before_ns = part->last_read_ns;
  for (int scan = 0; scan < scans; ++scan) {
    const int64_t arrived_ns = before_ns + (now_ns - before_ns) / scans * (scan + 1);
    int64_t t_ns;
    if (time_of(part, scan, arrived_ns, now_ns, real_ns, &t_ns) != 0) {
      ++imu->info.dropped;
      continue;
    }
    for (int kind = 0; kind < PF_IIO_KINDS; ++kind) {
      if (part->sensor[kind].axis[0] != NULL) {
        put(imu, kind, part, scan, t_ns);
      }
    }
  }
  part->last_read_ns = scans > 0 ? now_ns : part->last_read_ns;
  return scans;
}
