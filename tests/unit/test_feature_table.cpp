// Eviction by worth: what has not proved itself goes before what has, however long that has been out of view.
#include <vector>

#include "map/feature_table.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kCapacity = 8;
constexpr std::int64_t kNow = 1000;

struct Table {
  std::vector<double> block = std::vector<double>(2048);
  FeatureTable table;

  Table() {
    Arena arena(block.data(), block.size() * sizeof(double));
    TEST_ASSERT_TRUE(table.layout(arena, kCapacity));
    table.init();
  }
  int add(int observations, std::int64_t last_seen_ns, bool is_target = false) {
    const int entry = table.add(0);
    table[entry].observations = observations;
    table[entry].last_seen_ns = last_seen_ns;
    table[entry].is_target = is_target;
    return entry;
  }
};

void test_eviction_should_spare_proven_features_when_unproven_ones_were_seen_later() {
  Table t;
  const int proven = t.add(10, 1);
  const int young = t.add(9, 500);
  const int unproven = t.add(2, 999);
  TEST_ASSERT_EQUAL_INT(unproven, t.table.least_useful(kNow));
  t.table.remove(unproven);
  TEST_ASSERT_EQUAL_INT(young, t.table.least_useful(kNow));
  t.table.remove(young);
  TEST_ASSERT_EQUAL_INT(proven, t.table.least_useful(kNow));
}

void test_eviction_should_keep_what_was_measured_twice_as_often() {
  Table t;
  t.add(40, 1);
  const int less = t.add(39, 999);
  TEST_ASSERT_EQUAL_INT(less, t.table.least_useful(kNow));
}

void test_eviction_should_take_the_longest_unseen_when_features_are_equally_proven() {
  for (const int observations : {1, 3, 10}) {
    Table t;
    t.add(observations, 700);
    const int oldest = t.add(observations, 20);
    t.add(observations, 300);
    TEST_ASSERT_EQUAL_INT(oldest, t.table.least_useful(kNow));
  }
}

void test_eviction_should_leave_what_is_in_view_and_the_target() {
  Table t;
  t.add(1, kNow);
  t.add(1, 5, true);
  TEST_ASSERT_EQUAL_INT(-1, t.table.least_useful(kNow));
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_eviction_should_spare_proven_features_when_unproven_ones_were_seen_later);
  RUN_TEST(test_eviction_should_keep_what_was_measured_twice_as_often);
  RUN_TEST(test_eviction_should_take_the_longest_unseen_when_features_are_equally_proven);
  RUN_TEST(test_eviction_should_leave_what_is_in_view_and_the_target);
  return UNITY_END();
}
