/* Samples of an accelerometer and a gyroscope through the kernel's IIO buffers (libiio).
 *
 *   char message[PF_IIO_MESSAGE];
 *   pf_iio_t *imu;
 *   if (pf_iio_open("", 0, &imu, message) != 0) puts(message);        the first unit of this machine
 *   pf_iio_start(imu, message);
 *   while (pf_iio_read(imu, 100, samples, 64, &count, message) == PF_IIO_SAMPLES) pf_push_imu(slam, samples, count);
 *   pf_iio_close(imu);
 *
 * A unit is one device that measures both, or two devices; then accelerations are interpolated at the times of the rates. Samples are
 * scaled to rad/s and m/s^2, turned by the mounting matrix of the kernel, and in order of time.
 * Functions that can fail return 0, or -1 with one line of plain text in message that says what is wrong and what to do.
 * A unit belongs to one thread at a time. It uses the heap when it is opened and started, not while it streams.
 */
#ifndef PLANEFOLD_PLATFORM_IIO_H
#define PLANEFOLD_PLATFORM_IIO_H

#include <planefold/planefold.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PF_IIO_MESSAGE 1024

typedef struct pf_iio pf_iio_t;

typedef struct pf_iio_device {
  char id[32];      /* iio:device0 */
  char name[64];    /* as the driver calls it */
  int32_t gyro;     /* 1: has a gyroscope of three axes */
  int32_t accel;    /* 1: has an accelerometer of three axes */
  int32_t buffered; /* 1: has a buffer, without which it cannot be used here */
  int32_t refused;  /* 1: this user may not read it */
} pf_iio_device_t;

/* Devices with either sensor. Gives how many there are, of which the first capacity are written. */
int pf_iio_list(pf_iio_device_t* devices, int capacity);

typedef enum pf_iio_stamp {
  PF_IIO_STAMP_ARRIVAL = 0,   /* taken here when the samples came, because the driver gives none */
  PF_IIO_STAMP_MONOTONIC = 1, /* CLOCK_MONOTONIC, by the kernel */
  PF_IIO_STAMP_CONVERTED = 2  /* by the kernel on its real-time clock, and converted here */
} pf_iio_stamp_t;

typedef struct pf_iio_info {
  pf_iio_device_t gyro, accel;
  double gyro_rate_hz, accel_rate_hz;   /* 0: the driver does not say */
  double gyro_range, accel_range;       /* [rad/s] [m/s^2] of the raw numbers; 0: not known */
  double gyro_mount[9], accel_mount[9]; /* row-major: unit = mount * sensor; identity where the kernel has none */
  uint32_t stamp;                       /* pf_iio_stamp_t, the least of both */
  int64_t samples;                      /* handed over */
  int64_t dropped;                      /* with a time that did not grow, or for lack of the other sensor's */
  int64_t departures;                   /* how often the unit was unplugged, or its driver failed */
} pf_iio_info_t;

/* name     part of the name, or the id, of a device with both sensors, or that two devices have in common; or ACCEL+GYRO
 * rate_hz  to ask for; 0: as it is */
int pf_iio_open(const char* name, double rate_hz, pf_iio_t** imu, char message[PF_IIO_MESSAGE]);
void pf_iio_close(pf_iio_t* imu); /* null is welcome */
void pf_iio_get_info(const pf_iio_t* imu, pf_iio_info_t* info);

int pf_iio_start(pf_iio_t* imu, char message[PF_IIO_MESSAGE]);

enum { PF_IIO_NOTHING = 0, PF_IIO_SAMPLES = 1, PF_IIO_GONE = 2 };

/* PF_IIO_SAMPLES, PF_IIO_NOTHING after timeout_ms, or PF_IIO_GONE when the unit was unplugged or its driver failed. capacity is at
 * least 1. */
int pf_iio_read(pf_iio_t* imu, int timeout_ms, pf_imu_sample_t* samples, int capacity, int* count,
                char message[PF_IIO_MESSAGE]);

/* After PF_IIO_GONE: looks for the unit again under its name, and streams. 0, or -1 while it is not there. */
int pf_iio_return(pf_iio_t* imu, char message[PF_IIO_MESSAGE]);

/* "1, 0, 0; 0, 1, 0; 0, 0, 1" as the kernel writes it. 0, or -1 where it is no rotation or reflection. */
int pf_iio_parse_mount(const char* text, double mount[9]);

/* One line on which rule lets other users than root read such devices. */
const char* pf_iio_permission_hint(void);

#ifdef __cplusplus
}
#endif

#endif
