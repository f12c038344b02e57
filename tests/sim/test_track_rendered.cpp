// Scenes of a few seconds, rendered, and what the library says and knows in them.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "same.h"
#include "support/rendered_run.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

using Start = RenderedRun::Start;

double position_variance(const RenderedRun::Frame& f) {
  return f.pose.covariance[21] + f.pose.covariance[28] + f.pose.covariance[35];
}

/// Angle between the turns from a to b and from c to d [deg].
double turn_apart_deg(const pf_pose_t& a, const pf_pose_t& b, const pf_pose_t& c, const pf_pose_t& d) {
  const auto turn = [](const pf_pose_t& from, const pf_pose_t& to, double q[4]) {  // conjugate(from) to
    const double *f = from.q_WC, *t = to.q_WC;
    q[0] = f[0] * t[0] + f[1] * t[1] + f[2] * t[2] + f[3] * t[3];
    q[1] = f[0] * t[1] - f[1] * t[0] - f[2] * t[3] + f[3] * t[2];
    q[2] = f[0] * t[2] + f[1] * t[3] - f[2] * t[0] - f[3] * t[1];
    q[3] = f[0] * t[3] - f[1] * t[2] + f[2] * t[1] - f[3] * t[0];
  };
  double p[4], q[4], cosine = 0;
  turn(a, b, p);
  turn(c, d, q);
  for (int i = 0; i < 4; ++i) cosine += p[i] * q[i];
  return 2 * std::acos(std::min(1.0, std::fabs(cosine))) * 57.29577951308232;
}

void tell(const char* what, const RenderedRun& run, std::size_t first) {
  int tracked = 0;
  for (std::size_t i = first; i < run.frames.size(); ++i) tracked += run.frames[i].status == PF_OK ? 1 : 0;
  std::printf("%s: tracked %d of %zu, worst error %.4f m\n", what, tracked, run.frames.size() - first,
              run.worst_error(first));
}

void test_desk_should_be_tracked_in_every_frame_when_it_starts_at_the_target() {
  RenderedRun run("desk", 120, Start::kRectangle);
  const int tracked = run.tracked_until(120);
  tell("desk", run, 0);
  TEST_ASSERT_EQUAL_INT(120, tracked);
  TEST_ASSERT_TRUE(run.worst_error(0) < 0.03);
}

void test_desk_should_start_without_a_target_and_then_be_tracked() {
  RenderedRun run("desk", 120, Start::kNone);
  run.tracked_until(120);
  std::size_t first = 0;
  while (first < 120 && run.frames[first].status != PF_OK) {
    TEST_ASSERT_EQUAL_INT(PF_NOTE_STARTING, run.frames[first].status);
    ++first;
  }
  std::printf("started in frame %zu\n", first);
  TEST_ASSERT_TRUE(first < 60);
  for (std::size_t i = first; i < 120; ++i) TEST_ASSERT_EQUAL_INT(PF_OK, run.frames[i].status);
}

void test_a_picture_of_hardly_any_contrast_should_be_tracked() {
  RenderedRun run("desk", 90, Start::kNone);
  run.contrast = 0.1;
  run.tracked_until(90);
  tell("faint desk", run, 30);
  int tracked = 0;
  for (std::size_t i = 45; i < 90; ++i) tracked += run.frames[i].status == PF_OK ? 1 : 0;
  TEST_ASSERT_GREATER_OR_EQUAL_INT(42, tracked);
}

/// First depths that are wrong by a factor let a filter settle in another explanation of the first frames, for good.
void test_a_start_at_a_target_should_be_right_when_the_first_depths_are_far_off() {
  const struct {
    const char* scene;
    double depth_m;
  } starts[] = {{"desk", 0.1}, {"desk", 10}, {"room", 0.15}, {"room", 2}, {"room", 4}};  // the wall is 0.7 m away
  for (const auto& start : starts) {
    RenderedRun run(start.scene, 120, Start::kRectangle);
    run.config.first_depth.from_map = 0;
    run.config.first_depth.depth = start.depth_m;
    run.create();
    run.start_at_rectangle();
    const int tracked = run.tracked_until(120);
    std::printf("first depths of %g m: ", start.depth_m);
    tell(start.scene, run, 60);
    TEST_ASSERT_EQUAL_INT(120, tracked);
    TEST_ASSERT_TRUE(run.worst_error(60) < 0.02);
  }
}

/// The camera moves about what it looks at. Once more parallax was there, the start without a target left the right solution, 0.02
/// degrees off, for one without that turn, and the run was 20 degrees off after 250 frames.
void test_a_start_should_not_leave_a_right_solution_when_the_camera_orbits_the_desk() {
  RenderedRun run("desk", 75, Start::kNone, [](pf_sim_options_t* options) { options->seed = 9; });
  run.skip(15);
  run.tracked_until(60);
  double worst = 0;
  int tracked = 0;
  const RenderedRun::Frame& first = run.frames.front();
  for (const RenderedRun::Frame& f : run.frames) {
    if (f.status != PF_OK) continue;
    ++tracked;
    worst = std::max(worst, turn_apart_deg(first.pose, f.pose, first.truth, f.truth));
  }
  std::printf("tracked %d, turn since the first frame at most %.2f deg off\n", tracked, worst);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(30, tracked);
  TEST_ASSERT_TRUE(worst < 2);
}

void test_tracking_should_go_on_when_the_exposure_jumps() {
  RenderedRun run("exposure", 150, Start::kRectangle);
  const int tracked = run.tracked_until(150);
  tell("exposure", run, 0);
  TEST_ASSERT_EQUAL_INT(150, tracked);
  TEST_ASSERT_TRUE(run.worst_error(0) < 0.03);
}

void test_tracking_should_go_on_when_somebody_walks_through_the_picture() {
  RenderedRun run("person", 220, Start::kRectangle);  // in the picture from about frame 100 to 210
  const int tracked = run.tracked_until(220);
  tell("person", run, 0);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(218, tracked);
  TEST_ASSERT_TRUE(run.worst_error(0) < 0.1);
}

void test_tracking_should_go_on_when_the_texture_repeats() {
  RenderedRun run("repeat", 120, Start::kRectangle);
  const int tracked = run.tracked_until(120);
  tell("repeat", run, 0);
  TEST_ASSERT_EQUAL_INT(120, tracked);
  TEST_ASSERT_TRUE(run.worst_error(0) < 0.04);
}

void test_black_frames_should_be_called_unusable_with_growing_covariance_and_then_tracked_through() {
  RenderedRun run("desk", 110, Start::kRectangle);
  TEST_ASSERT_EQUAL_INT(60, run.tracked_until(60));
  double before = position_variance(run.frames.back());
  for (int k = 0; k < 12; ++k) {  // 0.4 s
    TEST_ASSERT_TRUE(run.step(0));
    const RenderedRun::Frame& f = run.frames.back();
    TEST_ASSERT_EQUAL_INT(PF_NOTE_UNUSABLE, f.status);
    TEST_ASSERT_EQUAL_INT(PF_STATE_COASTING, f.state);
    TEST_ASSERT_TRUE(position_variance(f) > before);
    before = position_variance(f);
  }
  run.tracked_until(110);
  std::size_t again = 72;
  while (again < 110 && run.frames[again].status != PF_OK) ++again;
  std::printf("tracked again after %zu frames\n", again - 72);
  tell("after the dark", run, again);
  TEST_ASSERT_TRUE(again - 72 <= 5);
  for (std::size_t i = again; i < 110; ++i) TEST_ASSERT_EQUAL_INT(PF_OK, run.frames[i].status);
  TEST_ASSERT_TRUE(run.worst_error(again) < 0.03);
}

void test_a_covered_lens_should_be_called_lost_and_tracking_should_resume_when_the_view_comes_back() {
  RenderedRun run("desk", 200, Start::kRectangle);
  TEST_ASSERT_EQUAL_INT(45, run.tracked_until(45));
  run.tracked_until(105, 128);  // 2 s
  bool coasted = false;
  for (std::size_t i = 45; i < 105; ++i) {
    TEST_ASSERT_TRUE(run.frames[i].status == PF_NOTE_UNUSABLE || run.frames[i].status == PF_NOTE_LOST);
    coasted = coasted || run.frames[i].state == PF_STATE_COASTING;
  }
  TEST_ASSERT_TRUE(coasted);
  TEST_ASSERT_EQUAL_INT(PF_NOTE_LOST, run.frames[104].status);
  TEST_ASSERT_EQUAL_INT(PF_STATE_LOST, run.frames[104].state);
  run.tracked_until(200);
  std::size_t again = 105;
  while (again < 200 && run.frames[again].status != PF_OK) ++again;
  std::printf("tracked again after %zu frames\n", again - 105);
  tell("after the cover", run, 105);
  TEST_ASSERT_TRUE_MESSAGE(again < 200, "tracking did not resume");
  TEST_ASSERT_TRUE(run.worst_error(again) < 0.05);
}

void test_a_repeated_image_should_repeat_pose_and_status_and_the_next_one_should_be_tracked() {
  RenderedRun run("desk", 100, Start::kRectangle);
  TEST_ASSERT_EQUAL_INT(60, run.tracked_until(60));
  for (int k = 0; k < 20; ++k) {
    TEST_ASSERT_TRUE(run.step());
    TEST_ASSERT_EQUAL_INT(PF_OK, run.frames.back().status);
    const RenderedRun::Frame before = run.frames.back();
    TEST_ASSERT_TRUE(run.freeze());
    const RenderedRun::Frame& f = run.frames.back();
    TEST_ASSERT_EQUAL_INT(PF_OK, f.status);
    TEST_ASSERT_EQUAL_INT(PF_STATE_TRACKING, f.state);
    TEST_ASSERT_EQUAL_INT64(k + 1, f.report.duplicates);
    TEST_ASSERT_SAME(f.report.t_ns, f.pose.t_ns);
    TEST_ASSERT_TRUE(f.pose.t_ns > before.pose.t_ns);
    TEST_ASSERT_EQUAL_MEMORY(before.pose.p_WC, f.pose.p_WC, sizeof(f.pose.p_WC));
    TEST_ASSERT_EQUAL_MEMORY(before.pose.covariance, f.pose.covariance, sizeof(f.pose.covariance));
    TEST_ASSERT_EQUAL_INT(0, f.report.attempts);
  }
}

void test_a_frozen_camera_should_coast_after_coast_s_with_growing_covariance_and_be_found_again() {
  RenderedRun run("desk", 180, Start::kRectangle);
  TEST_ASSERT_EQUAL_INT(60, run.tracked_until(60));
  const int64_t last_ns = run.frames.back().pose.t_ns;
  double before = 0;
  bool coasted = false;
  while (run.frames.size() < 100) {  // 1.3 s; coast_s is 1
    TEST_ASSERT_TRUE(run.freeze());
    const RenderedRun::Frame& f = run.frames.back();
    const bool long_frozen = f.pose.t_ns - last_ns > 1000000000;
    TEST_ASSERT_EQUAL_INT(long_frozen ? PF_NOTE_UNUSABLE : PF_OK, f.status);
    if (long_frozen) {
      TEST_ASSERT_EQUAL_INT(PF_STATE_COASTING, f.state);
      TEST_ASSERT_TRUE(position_variance(f) > before);
      coasted = true;
    }
    before = position_variance(f);
  }
  TEST_ASSERT_TRUE(coasted);
  run.tracked_until(180);
  std::size_t again = 100;
  while (again < 180 && run.frames[again].status != PF_OK) ++again;
  std::printf("tracked again after %zu frames\n", again - 100);
  TEST_ASSERT_TRUE(again < 130);
  TEST_ASSERT_TRUE(run.worst_error(again) < 0.05);
}

/// For a device with little memory: the capacities of a dozen features in view.
void make_small(RenderedRun& run) {
  run.config.capacity.max_features = 20;
  run.config.capacity.max_observations = 16;
  run.config.capacity.max_state_dim = 90;
  run.config.map.features_in_view = 12;
  run.create();
  run.start_at_rectangle();
}

void test_a_map_of_a_dozen_features_should_be_tracked_from_the_target_on() {
  RenderedRun run("desk", 60, Start::kNone);
  make_small(run);
  const int tracked = run.tracked_until(60);
  tell("a dozen features", run, 0);
  TEST_ASSERT_EQUAL_INT(60, tracked);
}

/// The next frame after a tracked one comes later than a young map is followed through a gap.
void test_a_map_of_a_dozen_features_should_be_tracked_at_four_frames_a_second() {
  RenderedRun run("desk", 120, Start::kNone);
  make_small(run);
  int tracked = 0;
  for (int i = 0; i < 15; ++i) {
    TEST_ASSERT_TRUE(run.step());
    tracked += run.frames.back().status == PF_OK ? 1 : 0;
    pf_image_t skipped;
    for (int k = 0; k < 7; ++k) run.next_image(&skipped);
  }
  tell("a dozen features, 3.75 frames/s", run, 0);
  TEST_ASSERT_EQUAL_INT(15, tracked);
}

/// Between two frames the picture moves by up to a third of its width, and seldom as before.
void test_a_hand_that_shakes_should_be_followed_at_ten_frames_a_second() {
  RenderedRun run("desk", 40, Start::kRectangle, [](pf_sim_options_t* options) {
    options->rate_hz = 10;
    options->shake_rad = 0.05;
  });
  const int tracked = run.tracked_until(40);
  tell("a hand that shakes, 10 frames/s", run, 0);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(38, tracked);
  TEST_ASSERT_TRUE(run.worst_error(0) < 0.03);
}

void count_line(void* user, const char* line) {
  std::printf("%s\n", line);
  *static_cast<int*>(user) += std::strstr(line, "nominal timestamps") != nullptr ? 1 : 0;
}

void test_rows_should_have_no_times_of_their_own_when_timestamps_are_nominal() {
  RenderedRun global("desk", 40, Start::kNone), rows("desk", 40, Start::kNone);
  int lines = 0;
  rows.config.camera.readout_s = 0.03;
  rows.config.camera.timestamps = PF_TIMESTAMPS_NOMINAL;
  rows.config.log = count_line;
  rows.config.user = &lines;
  rows.create();
  TEST_ASSERT_EQUAL_INT(1, lines);
  TEST_ASSERT_EQUAL_INT(global.tracked_until(40), rows.tracked_until(40));
  TEST_ASSERT_EQUAL_MEMORY(&global.frames.back().pose, &rows.frames.back().pose, sizeof(pf_pose_t));
}

void test_pure_rotation_should_stay_starting_when_there_is_no_target() {
  RenderedRun run("rotation", 120, Start::kNone);
  run.tracked_until(120);
  for (const RenderedRun::Frame& f : run.frames) {
    TEST_ASSERT_EQUAL_INT(PF_NOTE_STARTING, f.status);
    TEST_ASSERT_EQUAL_INT(PF_STATE_STARTING, f.state);
    TEST_ASSERT_EQUAL_INT(0, f.report.features_point);  // no depth is claimed
  }
}

}  // namespace

/// What holds for both back ends.
void run_for_both() {
  RUN_TEST(test_desk_should_be_tracked_in_every_frame_when_it_starts_at_the_target);
  RUN_TEST(test_desk_should_start_without_a_target_and_then_be_tracked);
  RUN_TEST(test_a_start_should_not_leave_a_right_solution_when_the_camera_orbits_the_desk);
  RUN_TEST(test_tracking_should_go_on_when_the_exposure_jumps);
  RUN_TEST(test_tracking_should_go_on_when_somebody_walks_through_the_picture);
  RUN_TEST(test_tracking_should_go_on_when_the_texture_repeats);
  RUN_TEST(test_black_frames_should_be_called_unusable_with_growing_covariance_and_then_tracked_through);
  RUN_TEST(test_a_covered_lens_should_be_called_lost_and_tracking_should_resume_when_the_view_comes_back);
  RUN_TEST(test_a_repeated_image_should_repeat_pose_and_status_and_the_next_one_should_be_tracked);
  RUN_TEST(test_a_frozen_camera_should_coast_after_coast_s_with_growing_covariance_and_be_found_again);
  RUN_TEST(test_a_hand_that_shakes_should_be_followed_at_ten_frames_a_second);
  RUN_TEST(test_pure_rotation_should_stay_starting_when_there_is_no_target);
  RUN_TEST(test_a_picture_of_hardly_any_contrast_should_be_tracked);
}

int main(void) {
  UNITY_BEGIN();
  run_for_both();
  RUN_TEST(test_a_start_at_a_target_should_be_right_when_the_first_depths_are_far_off);
  RUN_TEST(test_a_map_of_a_dozen_features_should_be_tracked_from_the_target_on);
  RUN_TEST(test_a_map_of_a_dozen_features_should_be_tracked_at_four_frames_a_second);
  RUN_TEST(test_rows_should_have_no_times_of_their_own_when_timestamps_are_nominal);
  RenderedRun::backend = PF_BACKEND_WINDOW;
  std::printf("--- the window\n");
  run_for_both();
  return UNITY_END();
}
