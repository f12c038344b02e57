// Pixels that the caller gives in place of an image: by the features that they measure, and which of them measure none.
#include "map/given_pixels.h"
#include "support/textured_images.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kFeatures = 4, kRoom = 6;

struct Case {
  Case() {
    TEST_ASSERT_TRUE(given.layout(*arena, kFeatures, kRoom));
    TEST_ASSERT_TRUE(features.layout(*arena, kFeatures));
    features.init();
    for (const std::uint32_t id : {7u, 9u, 11u}) features[features.add(0)].external_id = id;
  }
  TestArena arena;
  FeatureTable features;
  GivenPixels given;
};

void test_a_pixel_should_belong_to_the_feature_of_its_id() {
  Case at;
  TEST_ASSERT_FALSE(at.given.are_given());
  at.given.inbox()[0] = {11, Vec2(1, 2), Scalar(0.5)};
  at.given.inbox()[1] = {13, Vec2(3, 4), Scalar(0.5)};
  at.given.inbox()[2] = {7, Vec2(5, 6), Scalar(0.5)};
  at.given.begin(3, at.features);
  TEST_ASSERT_TRUE(at.given.are_given());
  TEST_ASSERT_EQUAL_INT(3, at.given.count());
  TEST_ASSERT_TRUE(at.given.of(0) != nullptr && at.given.of(0)->pixel == Vec2(5, 6));
  TEST_ASSERT_NULL(at.given.of(1));
  TEST_ASSERT_TRUE(at.given.of(2) != nullptr && at.given.of(2)->pixel == Vec2(1, 2));
  TEST_ASSERT_NULL(at.given.of(3));  // no feature
}

void test_the_first_of_an_id_that_comes_twice_should_count() {
  Case at;
  at.given.inbox()[0] = {9, Vec2(1, 2), Scalar(0.5)};
  at.given.inbox()[1] = {9, Vec2(3, 4), Scalar(0.5)};
  at.given.begin(2, at.features);
  TEST_ASSERT_TRUE(at.given.of(1) != nullptr && at.given.of(1)->pixel == Vec2(1, 2));
}

void test_an_image_should_end_them() {
  Case at;
  at.given.begin(0, at.features);
  TEST_ASSERT_TRUE(at.given.are_given());
  TEST_ASSERT_NULL(at.given.of(0));
  at.given.end();
  TEST_ASSERT_FALSE(at.given.are_given());
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_a_pixel_should_belong_to_the_feature_of_its_id);
  RUN_TEST(test_the_first_of_an_id_that_comes_twice_should_count);
  RUN_TEST(test_an_image_should_end_them);
  return UNITY_END();
}
