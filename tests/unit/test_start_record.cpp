// Which frames of a long start stay in its record.
#include "bundle/start_record.h"
#include "support/textured_images.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kFeature = 3;

struct Record {
  TestArena arena;
  StartRecord record;

  Record() {
    TEST_ASSERT_TRUE(record.layout(*arena));
    record.init();
    for (int i = 0; i <= kFeature; ++i) record.add_feature(Vec3(0, 0, 1));
  }
  /// Frame n comes n seconds after the beginning, and has its one pixel at (n, 0).
  void add(int n) {
    const int k = record.add_frame(n * std::int64_t(1000000000), Quat::Identity(), Vec3::Zero());
    record.add_pixel(k, kFeature, Vec2(static_cast<Scalar>(n), 0));
  }
  int of(int k) const { return static_cast<int>(record.frame(k).t_ns / 1000000000); }
  bool has(int n) const {
    for (int k = 0; k < record.frames(); ++k)
      if (of(k) == n) return record.pixel(k, kFeature).x() == static_cast<Scalar>(n);
    return false;
  }
};

void test_a_full_record_should_drop_every_second_frame() {
  Record r;
  for (int n = 0; n <= StartRecord::kMaxFrames; ++n) r.add(n);
  TEST_ASSERT_EQUAL_INT(StartRecord::kMaxFrames / 2 + 1, r.record.frames());
  for (int k = 0; k < r.record.frames(); ++k) {
    TEST_ASSERT_EQUAL_INT(2 * k, r.of(k));
    TEST_ASSERT_TRUE(r.has(2 * k));
  }
}

void test_a_held_frame_should_stay() {
  for (const int held : {0, 1, 19, 20, StartRecord::kMaxFrames - 1}) {
    Record r;
    for (int n = 0; n < 200; ++n) {
      r.add(n);
      if (n == held) r.record.hold_newest();
      TEST_ASSERT_TRUE_MESSAGE(n < held || r.has(held), "the held frame is gone, or its pixels are another's");
      for (int k = 1; k < r.record.frames(); ++k) TEST_ASSERT_TRUE(r.of(k) > r.of(k - 1));
    }
    TEST_ASSERT_TRUE(r.has(199));
  }
}

void test_a_record_that_begins_again_should_hold_nothing() {
  Record r;
  for (int n = 0; n < 2; ++n) r.add(n);
  r.record.hold_newest();
  r.record.init();
  r.record.add_feature(Vec3(0, 0, 1));
  for (int n = 0; n <= StartRecord::kMaxFrames; ++n) r.record.add_frame(n, Quat::Identity(), Vec3::Zero());
  TEST_ASSERT_EQUAL_INT(2, static_cast<int>(r.record.frame(1).t_ns));
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_a_full_record_should_drop_every_second_frame);
  RUN_TEST(test_a_held_frame_should_stay);
  RUN_TEST(test_a_record_that_begins_again_should_hold_nothing);
  return UNITY_END();
}
