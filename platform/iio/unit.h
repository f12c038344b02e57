/* What the files of this room share: the sensors of a unit, and the readings that wait to be put together. */
#ifndef PLANEFOLD_PLATFORM_IIO_UNIT_H
#define PLANEFOLD_PLATFORM_IIO_UNIT_H

#include <iio.h>
#include <planefold_platform/iio.h>
#include <planefold_platform/stamps.h>

#include "buffer.h"

enum { PF_IIO_GYRO = 0, PF_IIO_ACCEL = 1, PF_IIO_KINDS = 2 };

#define PF_IIO_WAITING 512 /* readings of one sensor that wait for the other's */

/* Three channels of a device, and how their numbers become a vector in the axes of the unit. */
typedef struct pf_iio_sensor {
  struct iio_channel* axis[3]; /* null: the device does not have this sensor, or it is not used */
  double scale[3], offset[3];  /* value = (raw + offset) scale */
  double mount[9];
} pf_iio_sensor_t;

/* A device that streams. */
typedef struct pf_iio_part {
  struct iio_device* device;
  struct iio_channel* time; /* null: there is none */
  pf_iio_buffer_t buffer;
  int real_time; /* 1: its times are of the real-time clock */
  int64_t started_ns, last_read_ns;
  pf_stamps_t stamps; /* of the scans that were kept */
  pf_iio_sensor_t sensor[PF_IIO_KINDS];
} pf_iio_part_t;

typedef struct pf_iio_reading {
  int64_t t_ns;
  double value[3];
} pf_iio_reading_t;

typedef struct pf_iio_queue {
  pf_iio_reading_t reading[PF_IIO_WAITING];
  int begin, count;
} pf_iio_queue_t;

struct pf_iio {
  char name[128];
  double rate_hz;
  struct iio_context* context;
  int parts; /* 1: one device with both sensors */
  pf_iio_part_t part[2];
  pf_iio_queue_t queue[PF_IIO_KINDS];
  pf_iio_info_t info;
  int64_t last_t_ns;
  int has_last;
  int64_t started_ns;
  int64_t samples_at_start;
  int gone;
};

/* One line for message, as printf; returns -1. */
int pf_iio_refuse(char message[PF_IIO_MESSAGE], const char* form, ...) __attribute__((format(printf, 2, 3)));

/* The three channels of a sensor of a device; 0, or -1 where one of them is missing. */
int pf_iio_find_axes(const struct iio_device* device, int kind, struct iio_channel* axis[3]);

void pf_iio_describe(const struct iio_device* device, pf_iio_device_t* description);

/* Chooses the devices for imu->name; the context is open. */
int pf_iio_choose(pf_iio_t* imu, char message[PF_IIO_MESSAGE]);

/* Scales, mounting matrix, range and rate of a sensor that a part has. */
void pf_iio_read_sensor(pf_iio_t* imu, pf_iio_part_t* part, int kind);

/* Nanoseconds of the monotonic clock, or of the real-time one. */
int64_t pf_iio_clock_ns(int real_time);

/* Readings of a part's buffer into the queues, with times that grow and are not ahead of the clock. Number of scans, 0 for nothing, or a
 * negative errno. */
int pf_iio_fetch(pf_iio_t* imu, pf_iio_part_t* part);

/* Puts waiting readings together. Number of samples. */
int pf_iio_join(pf_iio_t* imu, pf_imu_sample_t* samples, int capacity);

#endif
