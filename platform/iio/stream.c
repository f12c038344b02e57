#include <errno.h>
#include <math.h>
#include <string.h>
#include <time.h>

#include "unit.h"

static int64_t clock_now_ns(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

/* A channel of a scan in the byte order and length of this machine. */
static int64_t raw_of(const struct iio_channel* channel, const void* scan) {
  const struct iio_data_format* format = iio_channel_get_data_format(channel);
  unsigned char bytes[8] = {0};
  int64_t wide;
  int32_t word;
  int16_t half;
  iio_channel_convert(channel, bytes, scan);
  switch (format->length) {
    case 8:
      return format->is_signed ? (int64_t)(int8_t)bytes[0] : (int64_t)bytes[0];
    case 16:
      memcpy(&half, bytes, sizeof(half));
      return format->is_signed ? (int64_t)half : (int64_t)(uint16_t)half;
    case 32:
      memcpy(&word, bytes, sizeof(word));
      return format->is_signed ? (int64_t)word : (int64_t)(uint32_t)word;
    default:
      memcpy(&wide, bytes, sizeof(wide));
      return wide;
  }
}

static void put(pf_iio_t* imu, int kind, const pf_iio_sensor_t* sensor, const struct iio_buffer* buffer,
                const char* scan, const char* start, int64_t t_ns) {
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
    const char* at = (const char*)iio_buffer_first(buffer, sensor->axis[i]) + (scan - start);
    value[i] = ((double)raw_of(sensor->axis[i], at) + sensor->offset[i]) * sensor->scale[i];
  }
  for (int i = 0; i < 3; ++i) {
    const double* row = sensor->mount + 3 * i;
    reading->value[i] = row[0] * value[0] + row[1] * value[1] + row[2] * value[2];
  }
}

int pf_iio_fetch(pf_iio_t* imu, pf_iio_part_t* part) {
  const ssize_t bytes = iio_buffer_refill(part->buffer);
  const char* start;
  const char* end;
  ptrdiff_t step;
  int64_t now_ns, shift_ns, before_ns;
  int scans, i = 0;
  if (bytes < 0) {
    return bytes == -EAGAIN || bytes == -ETIMEDOUT || bytes == -EINTR ? 0 : (int)bytes;
  }
  start = (const char*)iio_buffer_start(part->buffer);
  end = (const char*)iio_buffer_end(part->buffer);
  step = iio_buffer_step(part->buffer);
  if (step <= 0 || end <= start) {
    return 0;
  }
  now_ns = clock_now_ns(CLOCK_MONOTONIC);
  shift_ns = part->real_time ? now_ns - clock_now_ns(CLOCK_REALTIME) : 0;
  before_ns = part->last_read_ns;
  scans = (int)((end - start) / step);
  for (const char* scan = start; scan + step <= end; scan += step, ++i) {
    int64_t t_ns;
    if (part->time != NULL) {
      t_ns = raw_of(part->time, (const char*)iio_buffer_first(part->buffer, part->time) + (scan - start)) + shift_ns;
    } else {
      t_ns = before_ns + (now_ns - before_ns) / scans * (i + 1);
    }
    for (int kind = 0; kind < PF_IIO_KINDS; ++kind) {
      if (part->sensor[kind].axis[0] != NULL) {
        put(imu, kind, &part->sensor[kind], part->buffer, scan, start, t_ns);
      }
    }
  }
  part->last_read_ns = now_ns;
  return scans;
}
