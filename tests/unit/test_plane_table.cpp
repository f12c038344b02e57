// When a map begins again from a record of its first frames, walls of the plan stay as they came, and planes that were found go.
#include "map/plane_table.h"
#include "same.h"
#include "support/textured_images.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

PlaneOutline outline(Scalar side) {
  PlaneOutline square;
  square.count = 3;
  square.uv[0] = Vec2(0, 0);
  square.uv[1] = Vec2(side, 0);
  square.uv[2] = Vec2(0, side);
  return square;
}

void test_walls_should_be_kept_as_the_plan_has_them() {
  TestArena arena;
  PlaneTable planes;
  planes.layout(*arena, 4);
  planes.init();
  const int found = planes.add(5), wall = planes.add(6);
  const std::uint32_t id = planes[wall].id, id_found = planes[found].id;
  planes[wall].known = planes[wall].two_sided = true;
  planes[wall].roughness = Scalar(0.02);
  planes[wall].prior[0] = planes[wall].prior[5] = Scalar(0.25);
  planes[wall].prior[1] = Scalar(0.1);
  planes[wall].plan = outline(1);
  planes[wall].seen = planes[wall].support = outline(2);
  planes[wall].refused = 3;
  planes[wall].age = 20;
  planes.remember_merge(77, id_found);

  planes.keep_known();
  TEST_ASSERT_FALSE(planes.used(found));
  TEST_ASSERT_EQUAL_UINT32(0, planes.find(77));
  const PlaneEntry& kept = planes[wall];
  TEST_ASSERT_EQUAL_UINT32(id, kept.id);
  TEST_ASSERT_TRUE(kept.known);
  TEST_ASSERT_TRUE(kept.two_sided);
  TEST_ASSERT_SAME(Scalar(0.02), kept.roughness);
  TEST_ASSERT_SAME(Scalar(1), kept.seen.uv[1].x());
  TEST_ASSERT_SAME(Scalar(1), kept.support.uv[1].x());
  TEST_ASSERT_EQUAL_INT(0, kept.refused);
  TEST_ASSERT_EQUAL_INT(0, kept.age);
  const Mat3 covariance = kept.prior_covariance();
  TEST_ASSERT_SAME(Scalar(0.25), covariance(0, 0));
  TEST_ASSERT_SAME(Scalar(0.25), covariance(2, 2));
  TEST_ASSERT_SAME(Scalar(0.1), covariance(0, 1));
  TEST_ASSERT_SAME(Scalar(0.1), covariance(1, 0));
  // Ids are not used twice.
  TEST_ASSERT_TRUE(planes[planes.add(9)].id > id);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_walls_should_be_kept_as_the_plan_has_them);
  return UNITY_END();
}
