// The window where fewer than half of the points are found, as when the camera turns while it exposes: those agree on a pose.
#include <algorithm>
#include <cmath>

#include "support/rendered_run.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr std::size_t kFrames = 8;  ///< that are smeared

/// Angle between the rotations from frame a to frame b, estimated and true [rad].
double turn_error(const RenderedRun::Frame& first, const RenderedRun::Frame& last) {
  const auto between = [](const pf_pose_t& from, const pf_pose_t& to, double* q) {  // conjugate(from) * to
    const double *a = from.q_WC, *b = to.q_WC;
    q[0] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
    q[1] = a[0] * b[1] - a[1] * b[0] - a[2] * b[3] + a[3] * b[2];
    q[2] = a[0] * b[2] + a[1] * b[3] - a[2] * b[0] - a[3] * b[1];
    q[3] = a[0] * b[3] - a[1] * b[2] + a[2] * b[1] - a[3] * b[0];
  };
  double e[4], t[4];
  between(first.pose, last.pose, e);
  between(first.truth, last.truth, t);
  const double same = std::fabs(e[0] * t[0] + e[1] * t[1] + e[2] * t[2] + e[3] * t[3]);
  return 2 * std::acos(std::min(1.0, same));
}

/// From nothing; from frame `first` on some frames are smeared by 9 px. Returns how many of these are tracked, and how far
/// the rotation is off at worst [rad].
int follow_smeared(std::size_t first, double* off) {
  RenderedRun::backend = PF_BACKEND_WINDOW;
  RenderedRun run("room", 64, RenderedRun::Start::kNone);
  run.tracked_until(first);
  TEST_ASSERT_EQUAL_INT(PF_OK, run.frames.back().status);
  run.smear = 9;
  const int tracked = run.tracked_until(first + kFrames);
  double worst = 0;
  for (std::size_t i = first; i < first + kFrames; ++i)
    if (run.frames[i].status == PF_OK) worst = std::fmax(worst, turn_error(run.frames[first - 1], run.frames[i]));
  std::printf("smeared from frame %d on: %d of %d tracked, rotation off by up to %.4f\n", static_cast<int>(first),
              tracked, static_cast<int>(kFrames), worst);
  TEST_ASSERT_TRUE_MESSAGE(worst < 0.03, "rotation is off");
  *off = worst;
  return tracked;
}

void test_window_should_follow_by_what_a_smeared_picture_leaves() {
  int tracked = 0;
  constexpr std::size_t kFirst = 36, kRuns = 20;
  double off[kRuns];
  for (std::size_t k = 0; k < kRuns; ++k) tracked += follow_smeared(kFirst + k, &off[k]);
  TEST_ASSERT_GREATER_OR_EQUAL_INT(static_cast<int>(kRuns * kFrames * 4 / 5), tracked);
  std::nth_element(off, off + kRuns / 2, off + kRuns);
  TEST_ASSERT_TRUE_MESSAGE(off[kRuns / 2] < 0.012, "rotations are off in the median run");
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_window_should_follow_by_what_a_smeared_picture_leaves);
  return UNITY_END();
}
