// The filter's start with nothing known, of a camera that turns fast before texture that repeats: nothing tells depths, but what it says of
// its rotation has to be right.
#include <cmath>

#include "support/rendered_run.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr std::size_t kFrames = 90;
constexpr double kDegrees = 57.29577951308232;

void turn_fast(pf_sim_options_t* options) {
  options->repeated_texture = 1;
  options->swing_rad_s = 2.5;
  options->swing_from_s = 0.4;
  options->swing_to_s = 2.9;
}

struct Quaternion {
  double w, x, y, z;
};

Quaternion of(const pf_pose_t& pose) { return {pose.q_WC[0], pose.q_WC[1], pose.q_WC[2], pose.q_WC[3]}; }

/// a* b
Quaternion between(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z, a.w * b.x - a.x * b.w - a.y * b.z + a.z * b.y,
          a.w * b.y + a.x * b.z - a.y * b.w - a.z * b.x, a.w * b.z - a.x * b.y + a.y * b.x - a.z * b.w};
}

double angle(const Quaternion& q) { return 2 * std::atan2(std::hypot(q.x, q.y, q.z), std::fabs(q.w)) * kDegrees; }

void test_rotation_should_be_right_while_a_start_waits() {
  RenderedRun run("rotation", kFrames, RenderedRun::Start::kNone, turn_fast);
  double worst = 0, turned = 0;
  while (run.step()) {
    const Quaternion q = between(of(run.frames.front().pose), of(run.frames.back().pose));
    const Quaternion truth = between(of(run.frames.front().truth), of(run.frames.back().truth));
    worst = std::fmax(worst, angle(between(truth, q)));
    turned = std::fmax(turned, angle(truth));
  }
  std::printf("turned by %.1f degrees, off by up to %.1f\n", turned, worst);
  TEST_ASSERT_TRUE(turned > 20);
  TEST_ASSERT_TRUE(worst < 1.5);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_rotation_should_be_right_while_a_start_waits);
  return UNITY_END();
}
