#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "unit.h"

int pf_iio_parse_mount(const char* text, double mount[9]) {
  double m[9];
  double determinant;
  const char* at = text;
  for (int i = 0; i < 9; ++i) {
    char* end;
    m[i] = strtod(at, &end);
    if (end == at || !isfinite(m[i])) {
      return -1;
    }
    at = end + strspn(end, " \t");
    if (i < 8) {
      if (*at != (i % 3 == 2 ? ';' : ',')) {
        return -1;
      }
      ++at;
    }
  }
  if (at[strspn(at, " \t\r\n")] != '\0') {
    return -1;
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double dot = m[3 * i] * m[3 * j] + m[3 * i + 1] * m[3 * j + 1] + m[3 * i + 2] * m[3 * j + 2];
      if (fabs(dot - (i == j ? 1.0 : 0.0)) > 0.01) {
        return -1;
      }
    }
  }
  determinant =
      m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
  if (!(fabs(fabs(determinant) - 1.0) < 0.05)) {
    return -1;
  }
  memcpy(mount, m, sizeof(m));
  return 0;
}

static void read_mount(const struct iio_device* device, const struct iio_channel* channel, double mount[9]) {
  static const char* const names[] = {"in_mount_matrix", "mount_matrix"};
  const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  char text[256];
  memcpy(mount, identity, sizeof(identity));
  if (iio_channel_attr_read(channel, "mount_matrix", text, sizeof(text)) > 0 && pf_iio_parse_mount(text, mount) == 0) {
    return;
  }
  for (int i = 0; i < 2; ++i) {
    if (iio_device_attr_read(device, names[i], text, sizeof(text)) > 0 && pf_iio_parse_mount(text, mount) == 0) {
      return;
    }
  }
}

/* Of the raw numbers; the smallest of the three axes. Beyond what any unit measures it says nothing. */
static double range_of(const pf_iio_sensor_t* sensor, double most) {
  double range = most;
  for (int i = 0; i < 3; ++i) {
    const struct iio_data_format* format = iio_channel_get_data_format(sensor->axis[i]);
    const double largest = ldexp(1.0, (int)format->bits - (format->is_signed ? 1 : 0)) - 1.0;
    range = fmin(range, fabs((largest + sensor->offset[i]) * sensor->scale[i]));
  }
  return range < most ? range : 0.0;
}

static double set_rate(const struct iio_device* device, const struct iio_channel* channel, double rate_hz) {
  double rate = 0.0;
  if (rate_hz > 0.0 && iio_channel_attr_write_double(channel, "sampling_frequency", rate_hz) < 0) {
    (void)!iio_device_attr_write_double(device, "sampling_frequency", rate_hz);
  }
  if (iio_channel_attr_read_double(channel, "sampling_frequency", &rate) != 0 &&
      iio_device_attr_read_double(device, "sampling_frequency", &rate) != 0) {
    return 0.0;
  }
  return isfinite(rate) && rate > 0.0 ? rate : 0.0;
}

void pf_iio_read_sensor(pf_iio_t* imu, pf_iio_part_t* part, int kind) {
  pf_iio_sensor_t* sensor = &part->sensor[kind];
  const double rate = set_rate(part->device, sensor->axis[0], imu->rate_hz);
  for (int i = 0; i < 3; ++i) {
    sensor->scale[i] = 1.0;
    sensor->offset[i] = 0.0;
    if (iio_channel_attr_read_double(sensor->axis[i], "scale", &sensor->scale[i]) != 0) {
      sensor->scale[i] = 1.0;
    }
    if (iio_channel_attr_read_double(sensor->axis[i], "offset", &sensor->offset[i]) != 0) {
      sensor->offset[i] = 0.0;
    }
  }
  read_mount(part->device, sensor->axis[0], sensor->mount);
  if (kind == PF_IIO_GYRO) {
    imu->info.gyro_range = range_of(sensor, 1000.0);
    imu->info.gyro_rate_hz = rate;
    memcpy(imu->info.gyro_mount, sensor->mount, sizeof(sensor->mount));
  } else {
    imu->info.accel_range = range_of(sensor, 1e5);
    imu->info.accel_rate_hz = rate;
    memcpy(imu->info.accel_mount, sensor->mount, sizeof(sensor->mount));
  }
}
