/* Which time of a device is believed: it stands still, jumps, is set back, lies ahead, and recovers. */
#include <planefold_platform/stamps.h>
#include <unity.h>

#define SECOND INT64_C(1000000000)
#define FRAME (SECOND / 30)
#define BEGIN (1000 * SECOND)

void setUp(void) {}
void tearDown(void) {}

/* A device that gives a frame every 1/30 s, which arrives 5 ms after it was taken. */
typedef struct device {
  pf_stamps_t stamps;
  int64_t now_ns, longest_stop_ns, last_frame_ns;
  int by_device, by_arrival, dropped;
} device_t;

static void give(device_t* device, int64_t stamp_ns) {
  int64_t t_ns = -1;
  const int64_t before_ns = device->stamps.last_t_ns;
  const pf_stamp_choice_t choice = pf_choose_stamp(&device->stamps, pf_possible_stamp(stamp_ns, device->now_ns),
                                                   device->now_ns, device->now_ns, &t_ns);
  if (choice == PF_STAMP_DROP) {
    ++device->dropped;
  } else {
    TEST_ASSERT_TRUE(t_ns > before_ns);
    TEST_ASSERT_EQUAL_INT64(choice == PF_STAMP_DEVICE ? stamp_ns : device->now_ns, t_ns);
    pf_keep_stamp(&device->stamps, t_ns, device->now_ns);
    ++*(choice == PF_STAMP_DEVICE ? &device->by_device : &device->by_arrival);
    device->last_frame_ns = device->now_ns;
  }
  if (device->now_ns - device->last_frame_ns > device->longest_stop_ns) {
    device->longest_stop_ns = device->now_ns - device->last_frame_ns;
  }
  device->now_ns += FRAME;
}

static device_t begin(void) {
  device_t device = {{0, 0, 0}, BEGIN, 0, BEGIN, 0, 0, 0};
  for (int i = 0; i < 30; ++i) {
    give(&device, device.now_ns - SECOND / 200);
  }
  TEST_ASSERT_EQUAL_INT(30, device.by_device);
  return device;
}

static void test_frames_should_go_on_by_arrival_when_stamps_stand_still(void) {
  device_t device = begin();
  const int64_t still_ns = device.stamps.last_t_ns;
  for (int i = 0; i < 300; ++i) {
    give(&device, still_ns);
  }
  TEST_ASSERT_LESS_THAN_INT(10, device.dropped);
  TEST_ASSERT_EQUAL_INT(300 - device.dropped, device.by_arrival);
  TEST_ASSERT_TRUE(device.longest_stop_ns < SECOND / 2);
}

static void test_stamps_should_be_believed_again_when_they_grow_again(void) {
  device_t device = begin();
  const int64_t still_ns = device.stamps.last_t_ns;
  for (int i = 0; i < 60; ++i) {
    give(&device, still_ns);
  }
  /* The last time by arrival may lie after the next stamp: that one frame still goes by arrival. */
  for (int i = 0; i < 30; ++i) {
    give(&device, device.now_ns - SECOND / 200);
  }
  TEST_ASSERT_GREATER_OR_EQUAL_INT(30 + 29, device.by_device);
}

static void test_frames_should_go_on_when_the_clock_was_set_back(void) {
  device_t device = begin();
  for (int i = 0; i < 300; ++i) {
    give(&device, device.now_ns - 600 * SECOND);
  }
  TEST_ASSERT_LESS_THAN_INT(10, device.dropped);
  TEST_ASSERT_TRUE(device.longest_stop_ns < SECOND / 2);
}

static void test_single_stamp_should_only_cost_its_frame_when_it_repeats_or_jumps_back(void) {
  device_t device = begin();
  give(&device, device.stamps.last_t_ns);
  give(&device, device.now_ns - SECOND);
  for (int i = 0; i < 30; ++i) {
    give(&device, device.now_ns - SECOND / 200);
  }
  TEST_ASSERT_EQUAL_INT(2, device.dropped);
  TEST_ASSERT_EQUAL_INT(60, device.by_device);
}

static void test_stamp_should_not_be_possible_when_it_is_of_another_clock(void) {
  TEST_ASSERT_EQUAL_INT64(BEGIN, pf_possible_stamp(BEGIN, BEGIN));
  TEST_ASSERT_EQUAL_INT64(BEGIN + PF_STAMP_AHEAD_NS, pf_possible_stamp(BEGIN + PF_STAMP_AHEAD_NS, BEGIN));
  TEST_ASSERT_EQUAL_INT64(0, pf_possible_stamp(BEGIN + PF_STAMP_AHEAD_NS + 1, BEGIN));
  TEST_ASSERT_EQUAL_INT64(0, pf_possible_stamp(BEGIN + 3600 * SECOND, BEGIN));
  TEST_ASSERT_EQUAL_INT64(0, pf_possible_stamp(0, BEGIN));
  TEST_ASSERT_EQUAL_INT64(0, pf_possible_stamp(-1, BEGIN));
}

static void test_stamp_an_hour_ahead_should_cost_nothing_but_its_own_time(void) {
  device_t device = begin();
  give(&device, device.now_ns + 3600 * SECOND);
  TEST_ASSERT_EQUAL_INT(1, device.by_arrival);
  for (int i = 0; i < 30; ++i) {
    give(&device, device.now_ns - SECOND / 200);
  }
  TEST_ASSERT_EQUAL_INT(0, device.dropped);
  TEST_ASSERT_EQUAL_INT(60, device.by_device);
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_frames_should_go_on_by_arrival_when_stamps_stand_still);
  RUN_TEST(test_stamps_should_be_believed_again_when_they_grow_again);
  RUN_TEST(test_frames_should_go_on_when_the_clock_was_set_back);
  RUN_TEST(test_single_stamp_should_only_cost_its_frame_when_it_repeats_or_jumps_back);
  RUN_TEST(test_stamp_should_not_be_possible_when_it_is_of_another_clock);
  RUN_TEST(test_stamp_an_hour_ahead_should_cost_nothing_but_its_own_time);
  return UNITY_END();
}
