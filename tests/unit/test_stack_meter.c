#define _GNU_SOURCE
#include <string.h>

#include "skip.h"
#include "stack_meter.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void use_nothing(void* context) { (void)context; }

__attribute__((noinline)) static void use_bytes(void* context) {
  volatile char bytes[20000];
  for (size_t i = 0; i < sizeof(bytes); ++i) {
    bytes[i] = (char)i;
  }
  *(char*)context = bytes[77];
}

static void test_stack_meter_should_report_little_when_nothing_is_called(void) {
  TEST_ASSERT_LESS_THAN_size_t(2048, stack_meter_run(use_nothing, NULL));
}

static void test_stack_meter_should_report_an_array_when_it_is_written(void) {
  char out = 0;
  const size_t used = stack_meter_run(use_bytes, &out);
  TEST_ASSERT_EQUAL_INT(77, out);
  TEST_ASSERT_GREATER_OR_EQUAL_size_t(20000, used);
  TEST_ASSERT_LESS_THAN_size_t(23000, used);
}

static void test_stack_meter_should_agree_with_itself_when_run_twice(void) {
  char out = 0;
  TEST_ASSERT_EQUAL_size_t(stack_meter_run(use_bytes, &out), stack_meter_run(use_bytes, &out));
}

int main(void) {
  if (!stack_meter_is_meaningful()) {
    SKIP_PROGRAM("sanitizers change the use of stack");
  }
  UNITY_BEGIN();
  RUN_TEST(test_stack_meter_should_report_little_when_nothing_is_called);
  RUN_TEST(test_stack_meter_should_report_an_array_when_it_is_written);
  RUN_TEST(test_stack_meter_should_agree_with_itself_when_run_twice);
  return UNITY_END();
}
