#include "unit.h"

static pf_iio_reading_t* at(pf_iio_queue_t* queue, int i) {
  return &queue->reading[(queue->begin + i) % PF_IIO_WAITING];
}

static void drop_first(pf_iio_queue_t* queue) {
  queue->begin = (queue->begin + 1) % PF_IIO_WAITING;
  --queue->count;
}

/* Acceleration at a time between the first two waiting ones. */
static void interpolate(pf_iio_queue_t* accel, int64_t t_ns, double value[3]) {
  const pf_iio_reading_t* a = at(accel, 0);
  const pf_iio_reading_t* b = accel->count > 1 ? at(accel, 1) : a;
  const double span = (double)(b->t_ns - a->t_ns);
  double part = span > 0.0 ? (double)(t_ns - a->t_ns) / span : 0.0;
  part = part < 0.0 ? 0.0 : part > 1.0 ? 1.0 : part;
  for (int i = 0; i < 3; ++i) {
    value[i] = a->value[i] + part * (b->value[i] - a->value[i]);
  }
}

int pf_iio_join(pf_iio_t* imu, pf_imu_sample_t* samples, int capacity) {
  pf_iio_queue_t* gyro = &imu->queue[PF_IIO_GYRO];
  pf_iio_queue_t* accel = &imu->queue[PF_IIO_ACCEL];
  int count = 0;
  while (count < capacity && gyro->count > 0 && accel->count > 0) {
    const pf_iio_reading_t* rate = at(gyro, 0);
    pf_imu_sample_t* sample = &samples[count];
    while (accel->count > 1 && at(accel, 1)->t_ns <= rate->t_ns) {
      drop_first(accel);
    }
    if (at(accel, 0)->t_ns > rate->t_ns) {
      ++imu->info.dropped; /* before the first acceleration */
      drop_first(gyro);
      continue;
    }
    if (at(accel, 0)->t_ns < rate->t_ns && accel->count < 2) {
      break; /* until the acceleration behind it has come */
    }
    sample->t_ns = rate->t_ns;
    for (int i = 0; i < 3; ++i) {
      sample->gyro[i] = rate->value[i];
    }
    interpolate(accel, rate->t_ns, sample->accel);
    drop_first(gyro);
    if (imu->has_last && sample->t_ns <= imu->last_t_ns) {
      ++imu->info.dropped;
      continue;
    }
    imu->has_last = 1;
    imu->last_t_ns = sample->t_ns;
    ++imu->info.samples;
    ++count;
  }
  return count;
}
