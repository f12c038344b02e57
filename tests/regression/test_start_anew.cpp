// The filter's start with nothing known where most new corners are never found again: a record that runs out of features begins again with
// those that were found.
#include "support/rendered_run.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr std::size_t kFrames = 90;

void test_start_should_keep_what_is_found_where_most_corners_are_never_found_again() {
  for (const double share : {0.6, 0.7}) {
    RenderedRun run("desk", kFrames, RenderedRun::Start::kNone);
    run.flicker = share;
    std::size_t begun = 0;
    while (run.step() && run.frames.back().state != PF_STATE_TRACKING) ++begun;
    std::printf("%.2f of the picture flickers: tracking from frame %d on\n", share, static_cast<int>(begun));
    TEST_ASSERT_LESS_THAN_size_t(kFrames, begun);
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_start_should_keep_what_is_found_where_most_corners_are_never_found_again);
  return UNITY_END();
}
