// Places of the present map beside those of maps that were left.
#include "geometry/so3.h"
#include "memory/place_table.h"
#include "support/textured_images.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kCapacity = 4;

struct Bench {
  TestArena arena;
  PlaceTable table;

  Bench() {
    TEST_ASSERT_TRUE(table.layout(*arena, kCapacity));
    table.init();
  }
  KeptPlace place(std::uint32_t id, Scalar x) const {
    KeptPlace place;
    place.id = id;
    place.count = 10;
    place.p_WK = Vec3(x, 0, 0);
    return place;
  }
};

void test_places_of_a_map_that_was_left_should_not_be_present() {
  Bench bench;
  bench.table.keep(bench.place(1, 0));
  bench.table.keep(bench.place(2, 3));
  TEST_ASSERT_FALSE(bench.table.has_other());
  bench.table.leave(7);
  TEST_ASSERT_TRUE(bench.table.has_other());
  TEST_ASSERT_EQUAL_INT(2, bench.table.count());
  for (int i = 0; i < 2; ++i) TEST_ASSERT_FALSE(bench.table.is_present(i));
  bench.table.keep(bench.place(3, 0));
  TEST_ASSERT_TRUE(bench.table.is_present(2));
  bench.table.clear_present();
  TEST_ASSERT_EQUAL_INT(2, bench.table.count());
  bench.table.join(8);
  TEST_ASSERT_FALSE(bench.table.is_present(0));
  bench.table.join(7);
  TEST_ASSERT_TRUE(bench.table.is_present(0) && bench.table.is_present(1));
  TEST_ASSERT_FALSE(bench.table.has_other());
}

void test_a_move_should_leave_places_of_other_maps() {
  Bench bench;
  bench.table.keep(bench.place(1, 1));
  bench.table.leave(7);
  bench.table.keep(bench.place(2, 1));
  const Similarity T = {exp_so3(Vec3(0, 0, Scalar(0.5))), Vec3(0, 1, 0), 2};
  bench.table.move(T);
  TEST_ASSERT_TRUE((bench.table[0].p_WK - Vec3(1, 0, 0)).norm() == Scalar(0));
  TEST_ASSERT_TRUE((bench.table[1].p_WK - T.of(Vec3(1, 0, 0))).norm() < Scalar(1e-6));
}

/// Two places at one spot of two maps have nothing to do with each other.
void test_redundancy_should_be_that_within_a_map() {
  Bench bench;
  bench.table.keep(bench.place(1, 0));
  bench.table.keep(bench.place(2, 1));
  bench.table.leave(7);
  bench.table.keep(bench.place(3, 0));
  bench.table.keep(bench.place(4, 10));
  TEST_ASSERT_TRUE(bench.table.keep(bench.place(5, 20)) >= 0);
  TEST_ASSERT_TRUE(bench.table.entry_of(1) <
                   0);  // the two of the other map are nearest to each other, and this one is the older
  for (const std::uint32_t id : {2u, 3u, 4u, 5u}) TEST_ASSERT_TRUE(bench.table.entry_of(id) >= 0);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_places_of_a_map_that_was_left_should_not_be_present);
  RUN_TEST(test_a_move_should_leave_places_of_other_maps);
  RUN_TEST(test_redundancy_should_be_that_within_a_map);
  return UNITY_END();
}
