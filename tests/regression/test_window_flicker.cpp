// The window where most new corners are never found again, as on a texture that is finer than a pixel: a map that has just
// begun is believed by the points that earlier frames have found.
#include "support/rendered_run.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr std::size_t kFrames = 90;

void test_window_should_begin_where_most_corners_are_never_found_again() {
  RenderedRun::backend = PF_BACKEND_WINDOW;
  RenderedRun run("desk", kFrames, RenderedRun::Start::kNone);
  run.flicker = 0.6;
  run.tracked_until(kFrames);
  int tracked = 0, lost = 0;
  for (const RenderedRun::Frame& frame : run.frames) {
    tracked += frame.status == PF_OK ? 1 : 0;
    lost += frame.state == PF_STATE_LOST || frame.state == PF_STATE_COASTING ? 1 : 0;
  }
  std::printf("%d frames tracked, %d coasting or lost\n", tracked, lost);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(static_cast<int>(kFrames) / 2, tracked);
  TEST_ASSERT_EQUAL_INT(0, lost);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_window_should_begin_where_most_corners_are_never_found_again);
  return UNITY_END();
}
