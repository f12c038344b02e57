// The state of the tracking and the status of the frame say the same.
#include "slam/tracking_state.h"
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
    tracking->begin_frame();
    status = tracking->conclude(report, StartProgress(), kMaxCoast, hooks);
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
    tracking.begin_frame();
    tracking.set_has_pose(report.t_ns);
    StartProgress start;
    start.recording = true;
    TEST_ASSERT_TRUE(tracking.conclude(report, start, kMaxCoast, settings.hooks) == Status::kStarting);
    TEST_ASSERT_TRUE(tracking.state() == SlamState::kStarting);
    report.t_ns += kFrame;  // and what was lost before is not lost now
    tracking.begin_frame();
    TEST_ASSERT_TRUE(tracking.conclude(report, start, kMaxCoast, settings.hooks) == Status::kCoasting);
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_a_start_that_begins_anew_should_be_starting_in_status_and_state);
  return UNITY_END();
}
