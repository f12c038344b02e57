// The window's start with nothing known: each frame adjusts the poses from which points were last seen, and the next one searches for them
// from there, with the velocities of these poses.
#include <algorithm>
#include <cmath>

#include "support/rendered_run.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr std::size_t kFrames = 40;

/// Median distance of this frame's matches from where they were searched for [px].
double median_miss(const pf_slam_t* slam) {
  std::vector<pf_match_t> matches(512);
  std::size_t count = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_matches(slam, matches.data(), matches.size(), &count));
  std::vector<double> miss;
  for (std::size_t i = 0; i < count; ++i) {
    const pf_match_t& m = matches[i];
    if (m.status != PF_MATCH_INLIER && m.status != PF_MATCH_OUTLIER) continue;
    miss.push_back(std::hypot(m.measured_px[0] - m.predicted_px[0], m.measured_px[1] - m.predicted_px[1]));
  }
  TEST_ASSERT_GREATER_THAN_size_t(20, miss.size());
  std::nth_element(miss.begin(), miss.begin() + static_cast<std::ptrdiff_t>(miss.size() / 2), miss.end());
  return miss[miss.size() / 2];
}

/// The largest over the frames of a start in which the camera's motion is known (from the third frame on).
double worst_miss(const char* scene) {
  RenderedRun::backend = PF_BACKEND_WINDOW;
  RenderedRun run(scene, kFrames, RenderedRun::Start::kNone);
  double worst = 0;
  while (run.step() && run.frames.back().state == PF_STATE_STARTING)
    if (run.frames.size() > 3) worst = std::fmax(worst, median_miss(run.slam));
  std::printf("%d frames, off by up to %.2f px\n", static_cast<int>(run.frames.size()), worst);
  return worst;
}

void test_start_should_search_where_the_camera_is_going() { TEST_ASSERT_TRUE(worst_miss("desk") < 1.5); }

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_start_should_search_where_the_camera_is_going);
  return UNITY_END();
}
