// A second known pose gives the window its scale.
#include <cmath>

#include "support/rendered_run.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kFrames = 200;

double distance(const pf_pose_t& a, const pf_pose_t& b) {
  return std::hypot(a.p_WC[0] - b.p_WC[0], a.p_WC[1] - b.p_WC[1], a.p_WC[2] - b.p_WC[2]);
}

/// Mean of the estimated over the true distances from the first frame, over the last frames.
double scale(const RenderedRun& run) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = kFrames - 40; i < kFrames; ++i) {
    const double* p = run.frames[i].pose.p_WC;
    if (run.frames[i].status != PF_OK) continue;
    sum += std::hypot(p[0], p[1], p[2]) / distance(run.frames[i].truth, run.frames[0].truth);
    ++count;
  }
  TEST_ASSERT_TRUE(count > 20);
  return sum / count;
}

/// From nothing, with half of the desk's depth as the first one, so that the scale is far off where nothing else tells it.
void begin(RenderedRun* run) {
  run->config.first_depth.depth = 0.5;
  run->create();
}

/// bound: of the scale's error. The nearer the second place, the less well it tells the scale.
void scales_from(std::size_t second, double bound) {
  RenderedRun::backend = PF_BACKEND_WINDOW;
  RenderedRun without("desk", kFrames, RenderedRun::Start::kNone), with("desk", kFrames, RenderedRun::Start::kNone);
  begin(&without);
  begin(&with);
  without.tracked_until(kFrames);
  pf_pose_t pose{};
  pose.q_WC[0] = 1;
  for (int i = 0; i < 6; ++i) pose.covariance[7 * i] = 1e-6;
  pose.p_WC[0] = distance(without.frames[second].truth, without.frames[0].truth);  // its distance is what counts
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_set_second_pose(with.slam, without.frames[second].truth.t_ns, &pose));
  with.tracked_until(kFrames);
  std::printf("frame %d: scale %.4f, without %.4f\n", static_cast<int>(second), scale(with), scale(without));
  TEST_ASSERT_TRUE(std::fabs(scale(with) - 1) < bound);
  TEST_ASSERT_TRUE(std::fabs(scale(without) - 1) > 0.3);
}

void test_second_pose_should_give_the_scale_of_a_running_map() { scales_from(120, 0.04); }
void test_second_pose_should_give_the_scale_before_depths_are_known() { scales_from(26, 0.1); }

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_second_pose_should_give_the_scale_of_a_running_map);
  RUN_TEST(test_second_pose_should_give_the_scale_before_depths_are_known);
  return UNITY_END();
}
