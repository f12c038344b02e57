// A wrong calibration with the window: its lens is estimated, says honestly how well, and a new map begins at the calibration.
#include <cmath>

#include "same.h"
#include "support/rendered_run.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kFrames = 200;
constexpr double kK1 = 0.05, kFocalError = 0.02;

/// The scene's camera has a k1 that the calibration does not name, and a focal length that is 2 % too long.
struct WrongLens {
  pf_camera_t truth;
  RenderedRun run;

  explicit WrongLens(pf_camera_estimate_t estimate)
      : run("desk", kFrames, RenderedRun::Start::kNone, [](pf_sim_options_t* options) {
          options->camera.model = PF_CAMERA_RADTAN;
          options->camera.distortion[0] = kK1;
        }) {
    truth = run.config.camera;
    pf_camera_t& camera = run.config.camera;
    camera.model = PF_CAMERA_PINHOLE;
    camera.distortion[0] = 0;
    camera.fx *= 1 + kFocalError;
    camera.fy *= 1 + kFocalError;
    camera.estimate = estimate;
    camera.sigma_focal = 0.01;
    camera.sigma_aspect = 0.001;
    camera.sigma_centre_px = 0.01 * camera.width;
    camera.sigma_distortion[0] = 0.05;
    run.create();
    run.start_at_rectangle();
    TEST_ASSERT_GREATER_THAN_INT(kFrames - 10, run.tracked_until(kFrames));
  }
  double rms() const {
    double sum = 0;
    int count = 0;
    for (const RenderedRun::Frame& f : run.frames) {
      if (f.status != PF_OK) continue;
      sum += f.error_m * f.error_m;
      ++count;
    }
    return std::sqrt(sum / count);
  }
};

void test_window_should_estimate_a_wrong_lens_and_be_honest_about_it() {
  RenderedRun::backend = PF_BACKEND_WINDOW;
  WrongLens exact(PF_CAMERA_EXACT), estimated(PF_CAMERA_ESTIMATE);
  pf_camera_t lens;
  double covariance[100];
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_camera(estimated.run.slam, &lens, covariance));
  const double off[5] = {lens.fx - estimated.truth.fx, lens.fy - estimated.truth.fy, lens.cx - estimated.truth.cx,
                         lens.cy - estimated.truth.cy, lens.distortion[0] - kK1};
  for (int i = 0; i < 5; ++i) {
    const double sigma = std::sqrt(covariance[11 * i]);
    std::printf("parameter %d is off by %.4g, sigma %.4g\n", i, off[i], sigma);
    TEST_ASSERT_TRUE(std::fabs(off[i]) < 4 * sigma);
  }
  TEST_ASSERT_TRUE(std::fabs(off[0]) < 0.5 * kFocalError * estimated.truth.fx);
  TEST_ASSERT_TRUE(std::fabs(off[4]) < 0.2 * kK1);
  std::printf("camera off by %.4f m RMS, with the lens taken as exact %.4f m\n", estimated.rms(), exact.rms());
  TEST_ASSERT_TRUE(estimated.rms() < exact.rms());
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(estimated.run.slam));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_camera(estimated.run.slam, &lens, covariance));
  TEST_ASSERT_SAME(estimated.run.config.camera.fx, lens.fx);
  TEST_ASSERT_SAME(0, lens.distortion[0]);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_window_should_estimate_a_wrong_lens_and_be_honest_about_it);
  return UNITY_END();
}
