#include <string.h>

#include "unit.h"

static int matches(const struct iio_device* device, const char* text) {
  const char* name = iio_device_get_name(device);
  if (strcmp(iio_device_get_id(device), text) == 0) {
    return 1;
  }
  return name != NULL ? strstr(name, text) != NULL : text[0] == '\0';
}

/* The first device with these sensors whose name has the text in it. */
static struct iio_device* find(struct iio_context* context, const char* text, int gyro, int accel) {
  for (unsigned i = 0; i < iio_context_get_devices_count(context); ++i) {
    struct iio_device* device = iio_context_get_device(context, i);
    pf_iio_device_t description;
    if (iio_device_is_trigger(device) || !matches(device, text)) {
      continue;
    }
    pf_iio_describe(device, &description);
    if (description.buffered != 0 && description.gyro >= gyro && description.accel >= accel) {
      return device;
    }
  }
  return NULL;
}

int pf_iio_choose(pf_iio_t* imu, char message[PF_IIO_MESSAGE]) {
  char first[sizeof(imu->name)];
  const char* second = first;
  char* plus;
  struct iio_device *gyro, *accel;
  strcpy(first, imu->name);
  plus = strchr(first, '+');
  if (plus != NULL) {
    *plus = '\0';
    second = plus + 1;
  }
  gyro = plus == NULL ? find(imu->context, first, 1, 1) : NULL;
  accel = gyro;
  if (gyro == NULL) {
    accel = find(imu->context, first, 0, 1);
    gyro = find(imu->context, second, 1, 0);
  }
  if (gyro == NULL || accel == NULL) {
    return pf_iio_refuse(message, "iio:%s: no buffered %s of that name; pf-capture --list names what there is",
                         imu->name,
                         gyro == NULL && accel == NULL ? "accelerometer and gyroscope"
                         : gyro == NULL                ? "gyroscope"
                                                       : "accelerometer");
  }
  memset(imu->part, 0, sizeof(imu->part));
  imu->part[0].buffer.fd = imu->part[1].buffer.fd = -1;
  imu->parts = gyro == accel ? 1 : 2;
  imu->part[0].device = gyro;
  imu->part[1].device = accel;
  pf_iio_find_axes(gyro, PF_IIO_GYRO, imu->part[0].sensor[PF_IIO_GYRO].axis);
  pf_iio_find_axes(accel, PF_IIO_ACCEL, imu->part[imu->parts - 1].sensor[PF_IIO_ACCEL].axis);
  pf_iio_describe(gyro, &imu->info.gyro);
  pf_iio_describe(accel, &imu->info.accel);
  return 0;
}
