/* The inertial room without a device: raw numbers, mounting matrices, how two sensors become one unit, and what is refused. */
#include <planefold_platform/iio.h>
#include <string.h>
#include <unity.h>

#include "../../platform/iio/unit.h"

void setUp(void) {}
void tearDown(void) {}

static struct iio_data_format format_of(unsigned length, unsigned bits, unsigned shift, int is_signed, int big_endian) {
  struct iio_data_format format;
  memset(&format, 0, sizeof(format));
  format.length = length;
  format.bits = bits;
  format.shift = shift;
  format.is_signed = is_signed != 0;
  format.is_be = big_endian != 0;
  return format;
}

static void test_raw_numbers_should_be_decoded_in_every_order_and_size(void) {
  const unsigned char two[2] = {0x12, 0xf0}, eight[8] = {0x00, 0, 0, 0, 0, 0, 0, 0x80};
  const unsigned char padded[4] = {0xfe, 0xff, 0x55, 0x55}, one[1] = {0xff};
  struct iio_data_format format = format_of(16, 16, 0, 1, 0);
  TEST_ASSERT_EQUAL_INT64(-4078, pf_iio_decode(&format, two));
  format = format_of(16, 16, 0, 1, 1);
  TEST_ASSERT_EQUAL_INT64(0x12f0, pf_iio_decode(&format, two));
  format = format_of(16, 12, 4, 1, 0);
  TEST_ASSERT_EQUAL_INT64(-255, pf_iio_decode(&format, two));
  format = format_of(16, 12, 4, 0, 0);
  TEST_ASSERT_EQUAL_INT64(0xf01, pf_iio_decode(&format, two));
  format = format_of(32, 16, 0, 1, 0);
  TEST_ASSERT_EQUAL_INT64(-2, pf_iio_decode(&format, padded));
  format = format_of(8, 8, 0, 1, 0);
  TEST_ASSERT_EQUAL_INT64(-1, pf_iio_decode(&format, one));
  format = format_of(64, 64, 0, 1, 0);
  TEST_ASSERT_EQUAL_INT64(INT64_MIN, pf_iio_decode(&format, eight));
}

static void test_mounting_matrices_should_be_read_and_bad_ones_refused(void) {
  static const char* const bad[] = {"",
                                    "1, 0, 0; 0, 1, 0; 0, 0",
                                    "1, 0, 0; 0, 1, 0; 0, 0, 1; 0",
                                    "1, 0, 0, 0, 1, 0, 0, 0, 1",
                                    "1, 0, 0; 0, 1, 0; 0, 0, nan",
                                    "0, 0, 0; 0, 0, 0; 0, 0, 0",
                                    "1, 0, 0; 1, 0, 0; 0, 0, 1",
                                    "2, 0, 0; 0, 2, 0; 0, 0, 2",
                                    "x"};
  const double expected[9] = {0, 1, 0, -1, 0, 0, 0, 0, 1};
  double mount[9] = {7};
  for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); ++i) {
    TEST_ASSERT_EQUAL_INT_MESSAGE(-1, pf_iio_parse_mount(bad[i], mount), bad[i]);
    TEST_ASSERT_DOUBLE_WITHIN(0, 7, mount[0]);
  }
  TEST_ASSERT_EQUAL_INT(0, pf_iio_parse_mount("0, 1, 0; -1, 0, 0; 0, 0, 1\n", mount));
  for (int i = 0; i < 9; ++i) {
    TEST_ASSERT_DOUBLE_WITHIN(0, expected[i], mount[i]);
  }
  TEST_ASSERT_EQUAL_INT(0, pf_iio_parse_mount("1,0,0;0,-1,0;0,0,1", mount));
}

static pf_iio_t imu;

static void add(int kind, int64_t t_ns, double x) {
  pf_iio_queue_t* queue = &imu.queue[kind];
  pf_iio_reading_t* reading = &queue->reading[(queue->begin + queue->count++) % PF_IIO_WAITING];
  reading->t_ns = t_ns;
  reading->value[0] = x;
  reading->value[1] = -x;
  reading->value[2] = 1.0;
}

static void test_two_sensors_should_become_one_by_interpolation_at_the_times_of_the_rates(void) {
  pf_imu_sample_t samples[8];
  memset(&imu, 0, sizeof(imu));
  add(PF_IIO_GYRO, 50, 1);
  add(PF_IIO_GYRO, 110, 2);
  add(PF_IIO_GYRO, 150, 3);
  add(PF_IIO_GYRO, 250, 4);
  TEST_ASSERT_EQUAL_INT(0, pf_iio_join(&imu, samples, 8));
  add(PF_IIO_ACCEL, 100, 10);
  TEST_ASSERT_EQUAL_INT(0, pf_iio_join(&imu, samples, 8)); /* the acceleration behind 110 may still come */
  TEST_ASSERT_EQUAL_INT64(1, imu.info.dropped);            /* nothing was known at 50 */
  add(PF_IIO_ACCEL, 200, 20);
  TEST_ASSERT_EQUAL_INT(1, pf_iio_join(&imu, samples, 1));
  TEST_ASSERT_EQUAL_INT(1, pf_iio_join(&imu, samples + 1, 7));
  TEST_ASSERT_EQUAL_INT64(110, samples[0].t_ns);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2, samples[0].gyro[0]);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 11, samples[0].accel[0]);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, -11, samples[0].accel[1]);
  TEST_ASSERT_EQUAL_INT64(150, samples[1].t_ns);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 15, samples[1].accel[0]);
  add(PF_IIO_ACCEL, 250, 25);
  TEST_ASSERT_EQUAL_INT(1, pf_iio_join(&imu, samples, 8)); /* at the very time: no need to wait */
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, 25, samples[0].accel[0]);
  TEST_ASSERT_EQUAL_INT64(3, imu.info.samples);
}

static void test_samples_should_be_dropped_when_their_time_does_not_grow(void) {
  pf_imu_sample_t samples[8];
  memset(&imu, 0, sizeof(imu));
  add(PF_IIO_ACCEL, 0, 1);
  add(PF_IIO_ACCEL, 1000, 1);
  add(PF_IIO_GYRO, 100, 1);
  add(PF_IIO_GYRO, 100, 2);
  add(PF_IIO_GYRO, 90, 3);
  add(PF_IIO_GYRO, 101, 4);
  TEST_ASSERT_EQUAL_INT(2, pf_iio_join(&imu, samples, 8));
  TEST_ASSERT_EQUAL_INT64(101, samples[1].t_ns);
  TEST_ASSERT_EQUAL_INT64(2, imu.info.dropped);
}

static void test_open_should_refuse_what_is_no_unit(void) {
  char message[PF_IIO_MESSAGE] = "";
  char name[400];
  pf_iio_t* opened = (pf_iio_t*)&imu;
  TEST_ASSERT_EQUAL_INT(-1, pf_iio_open("no unit has this name", 0, &opened, message));
  TEST_ASSERT_NULL(opened);
  TEST_ASSERT_NOT_NULL(strstr(message, "--list"));
  TEST_ASSERT_NULL(strchr(message, '\n'));
  memset(name, 'n', sizeof(name));
  name[sizeof(name) - 1] = '\0';
  TEST_ASSERT_EQUAL_INT(-1, pf_iio_open(name, 0, &opened, message));
  TEST_ASSERT_NOT_NULL(strstr(message, "too long"));
  TEST_ASSERT_EQUAL_INT(-1, pf_iio_open("x", 0, NULL, message));
  TEST_ASSERT_TRUE(pf_iio_list(NULL, 0) >= 0);
  TEST_ASSERT_NOT_NULL(strstr(pf_iio_permission_hint(), "udev"));
  pf_iio_close(NULL);
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_raw_numbers_should_be_decoded_in_every_order_and_size);
  RUN_TEST(test_mounting_matrices_should_be_read_and_bad_ones_refused);
  RUN_TEST(test_two_sensors_should_become_one_by_interpolation_at_the_times_of_the_rates);
  RUN_TEST(test_samples_should_be_dropped_when_their_time_does_not_grow);
  RUN_TEST(test_open_should_refuse_what_is_no_unit);
  return UNITY_END();
}
