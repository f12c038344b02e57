// Whether a camera stands still while something moves before it, from the record of a start.
#include "bundle/start_still.h"
#include "geometry/so3.h"
#include "support/bounds.h"
#include "support/filter_cases.h"
#include "support/test_cameras.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kColumns = 6, kRows = 4;

/// Features on a grid over the picture, and one later frame.
struct Grid {
  TestArena arena;
  StartRecord record;
  Camera camera = pinhole_camera();

  Grid() {
    TEST_ASSERT_TRUE(record.layout(*arena));
    record.init();
    for (int i = 0; i < kColumns * kRows; ++i) {
      Vec3 ray;
      TEST_ASSERT_TRUE(unproject(camera, first(i), &ray));
      record.add_feature(ray);
    }
  }

  Vec2 first(int i) const {
    return Vec2((static_cast<Scalar>(i % kColumns) + Scalar(0.5)) * static_cast<Scalar>(camera.width) / kColumns,
                (static_cast<Scalar>(i / kColumns) + Scalar(0.5)) * static_cast<Scalar>(camera.height) / kRows);
  }

  /// way(i): how far feature i has moved [px].
  template <typename Way>
  bool stands_still_after(Way&& way, Scalar turned_px = 0, int others = 0) {
    const Quat turned = exp_so3(Vec3(0, turned_px / camera.fx, 0));
    const int k = record.add_frame(33000000, turned, Vec3::Zero());
    for (int i = 0; i < kColumns * kRows; ++i) record.add_pixel(k, i, first(i) + Vec2(way(i), 0));
    return stands_still(camera, record, others);
  }
};

void test_camera_before_what_moves_should_stand_still() {
  Grid grid;
  TEST_ASSERT_TRUE(grid.stands_still_after([](int i) { return i % 2 == 0 ? Scalar(10) : Scalar(0.3); }));
  TEST_ASSERT_FALSE(is_still(grid.camera, grid.record, 0));
  TEST_ASSERT_TRUE(is_still(grid.camera, grid.record, 1));
}

void test_pose_that_turns_before_a_picture_that_does_not_should_be_told() {
  Grid grid;
  TEST_ASSERT_FALSE(grid.stands_still_after([](int) { return Scalar(0.3); }));
  TEST_ASSERT_TRUE(grid.stands_still_after([](int) { return Scalar(0.3); }, 4, 3));
}

void test_pose_that_turns_by_itself_should_not_be_told() {
  Grid grid;
  TEST_ASSERT_FALSE(grid.stands_still_after([](int) { return Scalar(0.3); }, 4, 2));
}

void test_camera_that_moves_should_not_stand_still() {
  Grid grid;
  // Sideways: farther features move less, and none not at all.
  TEST_ASSERT_FALSE(
      grid.stands_still_after([](int i) { return Scalar(1) + Scalar(0.5) * static_cast<Scalar>(i); }, 4, 3));
}

void test_few_features_that_stay_should_not_hold_a_camera() {
  Grid grid;
  TEST_ASSERT_FALSE(grid.stands_still_after([](int i) { return i % 4 == 0 ? Scalar(0.3) : Scalar(10); }));
}

void test_marks_on_a_picture_that_moves_should_not_hold_a_camera() {
  Grid grid;
  TEST_ASSERT_FALSE(grid.stands_still_after([](int i) { return i % 5 < 2 ? Scalar(0.3) : Scalar(10); }));
}

void test_horizon_that_stays_should_not_hold_a_camera() {
  Grid grid;
  TEST_ASSERT_FALSE(grid.stands_still_after([](int i) { return i < kColumns ? Scalar(0.3) : Scalar(10); }));
  // And not where no other rows are in view.
  Grid row;
  const int k = row.record.add_frame(33000000, Quat::Identity(), Vec3::Zero());
  for (int i = 0; i < 3 * kColumns / 2; ++i)
    row.record.add_pixel(k, i, row.first(i) + Vec2(i < kColumns ? Scalar(0.3) : Scalar(10), 0));
  TEST_ASSERT_FALSE(stands_still(row.camera, row.record, 0));
}

void test_empty_record_should_tell_nothing() {
  TestArena arena;
  StartRecord record;
  TEST_ASSERT_TRUE(record.layout(*arena));
  record.init();
  TEST_ASSERT_FALSE(stands_still(pinhole_camera(), record, 0));
  TEST_ASSERT_FALSE(is_still(pinhole_camera(), record, 0));
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_camera_before_what_moves_should_stand_still);
  RUN_TEST(test_pose_that_turns_before_a_picture_that_does_not_should_be_told);
  RUN_TEST(test_pose_that_turns_by_itself_should_not_be_told);
  RUN_TEST(test_camera_that_moves_should_not_stand_still);
  RUN_TEST(test_few_features_that_stay_should_not_hold_a_camera);
  RUN_TEST(test_marks_on_a_picture_that_moves_should_not_hold_a_camera);
  RUN_TEST(test_horizon_that_stays_should_not_hold_a_camera);
  RUN_TEST(test_empty_record_should_tell_nothing);
  return UNITY_END();
}
