// A camera that comes back around a block: the frame that closes the loop says by how much the poses before it have moved, and an anchor at
// the pose before it moves by just that.
#include <planefold_platform/sim.h>

#include <cstdio>
#include <memory>

#include "owned_context.h"
#include "support/given_poses.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kFrames = 990;    ///< of the walk
constexpr int kBefore = 800;    ///< is not yet back
constexpr double kMoved = 0.1;  ///< the closing takes away most of 0.19 m [m]

GivenPose given(const pf_slam_t* slam, std::uint32_t id) {
  pf_anchor_t anchor;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_anchor(slam, id, &anchor));
  return GivenPose::of(anchor);
}

double error_of(const pf_pose_t& pose, const pf_pose_t& truth) {
  return GivenPose::of(pose).distance({GivenPose::of(truth).q, GivenPose::of(truth).p, pose.map_id});
}

void test_the_correction_of_a_closed_loop_should_be_how_poses_move() {
  pf_sim_options_t options;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_options_default("loop", &options));
  options.seed = 104;
  options.frames = kFrames;
  std::printf("seed %d\n", 104);
  const std::unique_ptr<pf_sim_t, void (*)(pf_sim_t*)> sim(pf_sim_open("loop", &options), pf_sim_close);
  TEST_ASSERT_NOT_NULL(sim.get());
  pf_config_t config;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config));
  pf_sim_camera(sim.get(), &config.camera);
  config.backend = PF_BACKEND_WINDOW;
  config.map.features_in_view = 150;
  const OwnedContext context(config);
  pf_target_t target;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_target(sim.get(), PF_TARGET_RECTANGLE, &target));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_target(context.slam, &target));

  pf_image_t image;
  pf_pose_t truth, pose, before = {};
  pf_report_t report;
  std::uint32_t anchor = 0;
  double error_before = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    TEST_ASSERT_EQUAL_INT(1, pf_sim_next(sim.get(), &image, &truth));
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_frame(context.slam, &image));
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(context.slam, &pose));
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(context.slam, &report));
    const double error = error_of(pose, truth);
    if (report.places_returned > 0) {
      const Correction correction = Correction::of(report);
      const GivenPose was = GivenPose::of(before), told = correction.of(was), now = given(context.slam, anchor);
      std::printf("frame %d: moved by %.3f m, off by %.3f m before and %.3f m now; the anchor is off by %.2e\n", frame,
                  (told.p - was.p).norm(), error_before, error, told.distance(now));
      TEST_ASSERT_TRUE((told.p - was.p).norm() > kMoved);
      TEST_ASSERT_TRUE(told.distance(now) < (config.scalar == PF_SCALAR_FLOAT ? 1e-4 : 1e-6));
      TEST_ASSERT_TRUE(error < 0.25 * error_before);
      return;
    }
    if (frame < kBefore) continue;
    if (anchor != 0) TEST_ASSERT_EQUAL_INT(PF_OK, pf_remove_anchor(context.slam, anchor));
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_anchor_pose(context.slam, &pose, &anchor));
    before = pose;
    error_before = error;
  }
  TEST_FAIL_MESSAGE("no place has come back");
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_the_correction_of_a_closed_loop_should_be_how_poses_move);
  return UNITY_END();
}
