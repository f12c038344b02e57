// The state of the tracking and the status of the frame say the same.
#include "frame/tracking_state.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr std::int64_t kFrame = 33333333, kMaxCoast = 10 * kFrame;

/// A pose that began at time 0, and frames without inliers since then.
Status unsupported_frames(TrackingState* tracking, const Hooks& hooks, int frames) {
  tracking->init();
  tracking->set_has_pose(0);
  Status status = Status::kOk;
  for (int i = 1; i <= frames; ++i) {
    FrameReport report;
    report.t_ns = i * kFrame;
    tracking->begin_frame(kFrame);
    status = tracking->conclude(StartProgress(), kMaxCoast, hooks, &report);
  }
  return status;
}

void test_a_start_that_begins_anew_should_be_starting_in_status_and_state() {
  Settings settings;
  settings.min_inliers = 8;
  for (const int frames : {3, 20}) {
    TrackingState tracking(settings);
    const Status before = unsupported_frames(&tracking, settings.hooks, frames);
    TEST_ASSERT_TRUE(before == (frames == 3 ? Status::kCoasting : Status::kLost));
    FrameReport report;
    report.t_ns = (frames + 1) * kFrame;
    tracking.begin_frame(kFrame);
    tracking.set_has_pose(report.t_ns);
    StartProgress start;
    start.recording = true;
    TEST_ASSERT_TRUE(tracking.conclude(start, kMaxCoast, settings.hooks, &report) == Status::kStarting);
    TEST_ASSERT_TRUE(tracking.state() == SlamState::kStarting);
    report.t_ns += kFrame;  // and what was lost before is not lost now
    tracking.begin_frame(kFrame);
    TEST_ASSERT_TRUE(tracking.conclude(start, kMaxCoast, settings.hooks, &report) == Status::kCoasting);
  }
}

/// States of frames that all support their pose while a start that is under way gets its depths in the second of them.
void start_with_depths(TrackingState* tracking, const Settings& settings, SlamState* state, int frames) {
  tracking->set_has_pose(0);
  for (int i = 0; i < frames; ++i) {
    FrameReport report;
    report.t_ns = i * kFrame;
    report.inliers = settings.min_inliers;
    StartProgress start;
    start.recording = true;
    start.depth_known = i > 0;
    tracking->begin_frame(kFrame);
    tracking->conclude(start, kMaxCoast, settings.hooks, &report);
    state[i] = tracking->state();
  }
}

void test_a_map_after_a_loss_should_be_tracked_one_frame_after_its_depths() {
  Settings settings;
  settings.min_inliers = 8;
  for (const bool after_loss : {false, true}) {
    TrackingState tracking(settings);
    tracking.init();
    if (after_loss) {
      unsupported_frames(&tracking, settings.hooks, 20);
      tracking.begin_map();
    }
    SlamState state[3];
    start_with_depths(&tracking, settings, state, 3);
    TEST_ASSERT_TRUE(state[0] == SlamState::kStarting);
    TEST_ASSERT_TRUE(state[1] == (after_loss ? SlamState::kStarting : SlamState::kTracking));
    TEST_ASSERT_TRUE(state[2] == SlamState::kTracking);
  }
}

/// Reason of a frame with these counts, after a first pose.
FrameReason reason_of(int attempts, int matches, int consensus, int inliers, bool unusable = false) {
  Settings settings;
  settings.min_inliers = 8;
  TrackingState tracking(settings);
  tracking.init();
  tracking.set_has_pose(0);
  tracking.begin_frame(kFrame);
  FrameReport report;
  report.t_ns = kFrame;
  report.attempts = attempts;
  report.matches = matches;
  report.consensus = consensus;
  report.inliers = inliers;
  if (unusable) tracking.set_unusable();
  tracking.conclude(StartProgress(), kMaxCoast, settings.hooks, &report);
  return report.reason;
}

void test_reason_should_be_the_first_condition_that_a_frame_does_not_meet() {
  TEST_ASSERT_TRUE(reason_of(30, 20, 15, 15) == FrameReason::kNone);
  TEST_ASSERT_TRUE(reason_of(0, 0, 0, 0) == FrameReason::kNothingInView);
  TEST_ASSERT_TRUE(reason_of(30, 7, 7, 0) == FrameReason::kFewFound);
  TEST_ASSERT_TRUE(reason_of(30, 20, 7, 0) == FrameReason::kDisagree);
  TEST_ASSERT_TRUE(reason_of(30, 20, 15, 0) == FrameReason::kImprobable);
  TEST_ASSERT_TRUE(reason_of(30, 20, 15, 15, true) == FrameReason::kUncertain);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_a_start_that_begins_anew_should_be_starting_in_status_and_state);
  RUN_TEST(test_a_map_after_a_loss_should_be_tracked_one_frame_after_its_depths);
  RUN_TEST(test_reason_should_be_the_first_condition_that_a_frame_does_not_meet);
  return UNITY_END();
}
