// How far a point may be from a plane, by how far it is from the camera.
#include <cmath>

#include "frame/plane_settings.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

void test_distance_should_grow_with_the_range_beyond_the_depth_of_the_start() {
  Settings settings;
  settings.plane_distance = Scalar(0.01);
  settings.start_depth = 2;
  TEST_ASSERT_TRUE(distance_at(settings, Scalar(0.5)) == settings.plane_distance);
  TEST_ASSERT_TRUE(distance_at(settings, 2) == settings.plane_distance);
  TEST_ASSERT_TRUE(std::abs(distance_at(settings, 6) - 3 * settings.plane_distance) < Scalar(1e-6));
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_distance_should_grow_with_the_range_beyond_the_depth_of_the_start);
  return UNITY_END();
}
