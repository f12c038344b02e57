/* An inertial unit that is none: a HID sensor hub with accelerometer and gyroscope, made in user space (uhid), for which the
 * kernel's own drivers make IIO devices.   imu_device RATE_HZ
 *
 * Sample k says: acceleration (k, 1000, -k) mg and rate (k, -k, 1) hundredths of a degree per second, with k from 0 to 29999 and
 * from 0 again. It prints "ready" when the kernel has taken the unit, and leaves with SIGTERM. */
#include <errno.h>
#include <fcntl.h>
#include <linux/uhid.h>
#include <poll.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

// clang-format off
#define USAGE(number) 0x0a, (number) & 0xff, (number) >> 8
/* Of a selection: its usage, how many there are, and the usages themselves. */
#define SELECT(usage, count, ...) \
  USAGE(usage), 0x15, 1, 0x25, count, 0x75, 8, 0x95, 1, 0xa1, 0x02, __VA_ARGS__, 0xb1, 0x00, 0xc0
/* A physical collection: a feature report of interval [ms], reporting and power, and an input report of three numbers. */
#define SENSOR(usage, report, first, exponent)                                            \
  USAGE(usage), 0xa1, 0x00, 0x85, report,                                                 \
  USAGE(0x30e), 0x15, 0x00, 0x27, 0xff, 0xff, 0xff, 0x7f, 0x75, 32, 0x95, 1, 0xb1, 0x02,  \
  SELECT(0x316, 2, USAGE(0x840), USAGE(0x841)),                                           \
  SELECT(0x319, 3, USAGE(0x850), USAGE(0x851), USAGE(0x855)),                             \
  0x16, 0x01, 0x80, 0x26, 0xff, 0x7f, 0x75, 16, 0x95, 1, 0x65, 0x00, 0x55, exponent,      \
  USAGE(first), 0x81, 0x02, USAGE((first) + 1), 0x81, 0x02, USAGE((first) + 2), 0x81, 0x02, 0xc0

static const uint8_t descriptor[] = {
    0x05, 0x20, 0x09, 0x01, 0xa1, 0x01, /* sensors, a collection of them */
    SENSOR(0x73, 1, 0x453, 0x0d),       /* accelerometer, thousandths of g */
    SENSOR(0x76, 2, 0x457, 0x0e),       /* gyroscope, hundredths of a degree per second */
    0xc0};
// clang-format on

static uint32_t interval_ms;

static void send_event(int fd, const struct uhid_event* event) {
  if (write(fd, event, sizeof(*event)) != (ssize_t)sizeof(*event)) {
    fprintf(stderr, "uhid: %s\n", strerror(errno));
    exit(1);
  }
}

/* What the kernel asks: the interval, and whether it may set it. */
static void answer(int fd) {
  struct uhid_event event, reply;
  if (read(fd, &event, sizeof(event)) <= 0) {
    return;
  }
  memset(&reply, 0, sizeof(reply));
  if (event.type == UHID_GET_REPORT) {
    reply.type = UHID_GET_REPORT_REPLY;
    reply.u.get_report_reply.id = event.u.get_report.id;
    reply.u.get_report_reply.size = 7;
    reply.u.get_report_reply.data[0] = event.u.get_report.rnum;
    memcpy(reply.u.get_report_reply.data + 1, &interval_ms, 4);
    reply.u.get_report_reply.data[5] = 2; /* reports everything */
    reply.u.get_report_reply.data[6] = 2; /* at full power */
    send_event(fd, &reply);
  } else if (event.type == UHID_SET_REPORT) {
    reply.type = UHID_SET_REPORT_REPLY;
    reply.u.set_report_reply.id = event.u.set_report.id;
    send_event(fd, &reply);
  } else if (event.type == UHID_START) {
    puts("ready");
    fflush(stdout);
  }
}

static void measure(int fd, uint8_t report, int16_t x, int16_t y, int16_t z) {
  struct uhid_event event;
  const int16_t values[3] = {x, y, z};
  memset(&event, 0, sizeof(event));
  event.type = UHID_INPUT2;
  event.u.input2.size = 7;
  event.u.input2.data[0] = report;
  memcpy(event.u.input2.data + 1, values, sizeof(values));
  send_event(fd, &event);
}

static int64_t now_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

int main(int argc, char** argv) {
  struct uhid_event create;
  const double rate_hz = argc > 1 ? atof(argv[1]) : 50.0;
  const int64_t step_ns = (int64_t)(1e9 / rate_hz);
  const int fd = open("/dev/uhid", O_RDWR | O_CLOEXEC);
  int64_t next_ns = now_ns();
  int16_t k = 0;
  if (fd < 0) {
    fprintf(stderr, "/dev/uhid: %s\n", strerror(errno));
    return 1;
  }
  interval_ms = (uint32_t)(1e3 / rate_hz);
  memset(&create, 0, sizeof(create));
  create.type = UHID_CREATE2;
  strcpy((char*)create.u.create2.name, "planefold test unit");
  create.u.create2.bus = 0x03;
  create.u.create2.vendor = 0x1209;
  create.u.create2.product = 0x0001;
  create.u.create2.rd_size = sizeof(descriptor);
  memcpy(create.u.create2.rd_data, descriptor, sizeof(descriptor));
  send_event(fd, &create);
  for (;;) {
    struct pollfd wait = {fd, POLLIN, 0};
    const int64_t left_ns = next_ns - now_ns();
    if (left_ns > 0) {
      if (poll(&wait, 1, (int)(left_ns / 1000000) + 1) > 0) {
        answer(fd);
      }
      continue;
    }
    measure(fd, 1, k, 1000, (int16_t)-k);
    measure(fd, 2, k, (int16_t)-k, 1);
    k = (int16_t)(k == 29999 ? 0 : k + 1);
    next_ns = left_ns < -step_ns ? now_ns() + step_ns : next_ns + step_ns; /* a unit does not catch up */
  }
}
