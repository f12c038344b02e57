// How much longer the lens is than its calibration, by the points of one picture; and when a pose is not used for it.
#include <cmath>

#include "belief/lens_belief.h"
#include "belief/tuning.h"
#include "bundle/zoom_fit.h"
#include "geometry/so3.h"
#include "support/seeded_random.h"
#include "support/test_cameras.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr Scalar kSigma = Scalar(0.5);  ///< [px]

/// Pixels of 40 points in a room, of a lens exp(s) times as long, seen from the origin. flat: they lie on a wall that faces the camera.
ZoomPoints picture(const Camera& camera, Scalar s, bool flat, SeededRandom& random) {
  ZoomPoints points;
  for (int i = 0; i < 40; ++i) {
    const Scalar depth = flat ? Scalar(2) : static_cast<Scalar>(random.uniform(1, 4));
    const Vec3 m(static_cast<Scalar>(random.uniform(-0.4, 0.4)) * depth,
                 static_cast<Scalar>(random.uniform(-0.3, 0.3)) * depth, depth);
    PnpPoint point = {m, Scalar(1), Vec2::Zero()};
    Mat26 J_pose;
    Vec2 J_s;
    TEST_ASSERT_TRUE(project_zoomed(camera, CameraPose(), s, point, &point.pixel, &J_pose, &J_s));
    for (int k = 0; k < 2; ++k) point.pixel(k) += kSigma * static_cast<Scalar>(random.normal());
    points.add(point, kSigma * kSigma);
  }
  return points;
}

/// Where the frame is searched about: a little off.
CameraPose nearby(SeededRandom& random) {
  CameraPose pose;
  Vec3 turn;
  for (int k = 0; k < 3; ++k) {
    turn(k) = static_cast<Scalar>(0.01 * random.normal());
    pose.p_WC(k) = static_cast<Scalar>(0.03 * random.normal());
  }
  pose.q_WC = exp_so3(turn);
  return pose;
}

void test_zoom_should_be_found_within_its_own_sigma() {
  SeededRandom random(481);
  for (const double s : {0.0, 0.05, 0.16, -0.12}) {
    double nees = 0;
    constexpr int kTrials = 100;
    for (int trial = 0; trial < kTrials; ++trial) {
      const Camera camera = test_camera_of(trial % kTestCameras);
      const ZoomFit fit = picture(camera, static_cast<Scalar>(s), false, random).fit(camera, nearby(random));
      TEST_ASSERT_TRUE(fit.variance > Scalar(0));
      const double e = static_cast<double>(fit.log_ratio) - s;
      nees += e * e / static_cast<double>(fit.variance) / kTrials;
    }
    std::printf("log ratio %.2f: mean normalised square of its error %.2f\n", s, nees);
    TEST_ASSERT_TRUE(nees > 0.4 && nees < 1.3);
  }
}

/// There a longer lens and a camera that is nearer make the same picture.
void test_wall_that_faces_the_camera_should_say_little() {
  SeededRandom random(482);
  const Camera camera = pinhole_camera();
  for (int trial = 0; trial < 50; ++trial) {
    const ZoomFit fit = picture(camera, Scalar(0.16), true, random).fit(camera, CameraPose());
    const Scalar evidence =
        fit.variance > Scalar(0) ? lens_evidence(fit.log_ratio, fit.variance, Scalar(0)) : Scalar(0);
    TEST_ASSERT_TRUE(evidence < Scalar(3));
  }
}

void test_few_points_should_say_nothing() {
  ZoomPoints points;
  for (int i = 0; i < 5; ++i) points.add({Vec3(Scalar(i), 0, 5), Scalar(1), Vec2(320, 240)}, Scalar(1));
  TEST_ASSERT_TRUE(points.fit(pinhole_camera(), CameraPose()).variance == Scalar(0));
}

void test_more_points_than_there_is_room_for_should_be_left_out() {
  ZoomPoints points;
  for (int i = 0; i < 1000; ++i) points.add({Vec3(0, 0, 5), Scalar(1), Vec2(320, 240)}, Scalar(1));
  TEST_ASSERT_TRUE(points.fit(pinhole_camera(), CameraPose()).variance == Scalar(0));  // all at one place
}

void test_evidence_should_favour_a_change_only_beyond_what_a_calibration_leaves_open() {
  const Scalar variance = Scalar(1e-5);
  TEST_ASSERT_TRUE(lens_evidence(Scalar(0.005), variance, Scalar(0)) < Scalar(-1));
  TEST_ASSERT_TRUE(lens_evidence(Scalar(0.15), variance, Scalar(0)) == tuning::pose_belief::kMaxFrame);
  // A focal length that is known to 20 % only, and estimated, makes no change of it.
  TEST_ASSERT_TRUE(lens_evidence(Scalar(0.15), variance, Scalar(0.2)) < Scalar(0));
  // Nor does a picture that says next to nothing.
  TEST_ASSERT_TRUE(std::fabs(lens_evidence(Scalar(0.15), Scalar(10), Scalar(0))) < Scalar(0.1));
}

void test_change_should_be_suspected_at_once_and_certain_after_another_picture() {
  LensBelief belief;
  belief.begin_frame();
  belief.note(tuning::pose_belief::kMaxFrame, Scalar(0.15));
  TEST_ASSERT_FALSE(belief.is_kept());
  TEST_ASSERT_FALSE(belief.has_changed());
  // Hypotheses of one frame are one picture.
  belief.note(tuning::pose_belief::kMaxFrame, Scalar(0.15));
  TEST_ASSERT_FALSE(belief.has_changed());
  belief.begin_frame();
  belief.note(tuning::pose_belief::kMaxFrame, Scalar(0.15));
  TEST_ASSERT_TRUE(belief.has_changed());
  for (int i = 0; i < 100; ++i) {
    belief.begin_frame();
    belief.note(tuning::pose_belief::kMaxFrame, Scalar(0.15));
  }
  for (int i = 0; i < 3; ++i) {
    belief.begin_frame();
    belief.note(Scalar(-5), Scalar(0));
  }
  TEST_ASSERT_TRUE(belief.is_kept());  // it is as it was again
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_zoom_should_be_found_within_its_own_sigma);
  RUN_TEST(test_wall_that_faces_the_camera_should_say_little);
  RUN_TEST(test_few_points_should_say_nothing);
  RUN_TEST(test_more_points_than_there_is_room_for_should_be_left_out);
  RUN_TEST(test_evidence_should_favour_a_change_only_beyond_what_a_calibration_leaves_open);
  RUN_TEST(test_change_should_be_suspected_at_once_and_certain_after_another_picture);
  return UNITY_END();
}
