// A lens that is zoomed in mid-run: every point of the map is a sixth farther from the picture's middle, and a camera that is nearer
// explains most of that.
#include "support/rendered_run.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr std::size_t kBefore = 45, kZoomed = 30, kAfter = 45;

/// Frames that are tracked before the change, while it lasts, and once it has been taken back.
void follow_zoom(pf_backend_t backend) {
  RenderedRun::backend = backend;
  RenderedRun run("desk", static_cast<int>(kBefore + kZoomed + kAfter), RenderedRun::Start::kRectangle);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(static_cast<int>(kBefore) - 2, run.tracked_until(kBefore));
  run.zoom = 1.0 / 0.85;
  const int zoomed = run.tracked_until(kBefore + kZoomed);
  int named = 0;
  for (std::size_t i = kBefore; i < kBefore + kZoomed; ++i)
    named += run.frames[i].report.reason == PF_FRAME_REASON_LENS ? 1 : 0;
  std::printf("%s: %d of %d tracked with the longer lens, it is named in %d\n",
              backend == PF_BACKEND_FILTER ? "filter" : "window", zoomed, static_cast<int>(kZoomed), named);
  TEST_ASSERT_LESS_OR_EQUAL_INT(3, zoomed);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(1, named);
  run.zoom = 1;
  TEST_ASSERT_GREATER_OR_EQUAL_INT(static_cast<int>(kAfter) / 2, run.tracked_until(kBefore + kZoomed + kAfter));
  TEST_ASSERT_TRUE_MESSAGE(run.frames.back().error_m < 0.02, "the pose is wrong after the lens has changed back");
}

void test_filter_should_use_no_pose_of_a_lens_that_has_changed() { follow_zoom(PF_BACKEND_FILTER); }

void test_window_should_use_no_pose_of_a_lens_that_has_changed() { follow_zoom(PF_BACKEND_WINDOW); }

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_filter_should_use_no_pose_of_a_lens_that_has_changed);
  RUN_TEST(test_window_should_use_no_pose_of_a_lens_that_has_changed);
  return UNITY_END();
}
