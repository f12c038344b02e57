// The noise of matches on rendered frames: what the report says of it, and the warning where a wrong calibration is the reason.
#include <cstring>
#include <string>

#include "support/rendered_run.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

using Start = RenderedRun::Start;

void count_warnings(void* user, const char* line) {
  if (std::strstr(line, "check the calibration") != nullptr) ++*static_cast<int*>(user);
}

void count_lens_warnings(void* user, const char* line) {
  if (std::strstr(line, "the estimated lens is ") != nullptr) ++*static_cast<int*>(user);
}

/// The desk for some seconds, as a context sees it whose camera may be wrong; how often the log warned.
int warnings(RenderedRun& run, std::size_t frames, void (*log)(void*, const char*) = count_warnings) {
  int count = 0;
  run.config.log = log;
  run.config.user = &count;
  run.create();
  run.start_at_rectangle();
  run.tracked_until(frames);
  const pf_report_t& last = run.frames.back().report;
  std::printf("sigma_gate %.3f px, sigma_info %.3f px, %.1f frames, %d warnings\n", last.sigma_gate_px,
              last.sigma_info_px, last.correlation_frames, count);
  return count;
}

void test_log_should_not_warn_and_noise_should_be_plausible_when_the_calibration_is_right() {
  RenderedRun run("desk", 150, Start::kNone);
  TEST_ASSERT_EQUAL_INT(0, warnings(run, 150));
  const pf_report_t& last = run.frames.back().report;
  TEST_ASSERT_TRUE(last.sigma_gate_px >= 0.1 && last.sigma_gate_px < 0.3);
  TEST_ASSERT_TRUE(last.correlation_frames >= 1 && last.correlation_frames <= 30);
  TEST_ASSERT_DOUBLE_WITHIN(1e-5, last.sigma_gate_px * std::sqrt(last.correlation_frames), last.sigma_info_px);
}

void test_log_should_warn_once_when_the_lens_is_wrong() {
  RenderedRun run("desk", 150, Start::kNone);
  run.config.camera.model = PF_CAMERA_RADTAN;
  run.config.camera.distortion[0] = -0.3;
  TEST_ASSERT_EQUAL_INT(1, warnings(run, 150));
  TEST_ASSERT_TRUE(run.frames.back().report.sigma_gate_px > 0.3);
}

void test_log_should_warn_once_when_the_estimated_lens_leaves_its_prior() {
  for (const double error : {0.0, 0.03}) {
    RenderedRun run("desk", 150, Start::kNone);
    run.config.camera.fx *= 1 + error;
    run.config.camera.fy *= 1 + error;
    run.config.camera.estimate = PF_CAMERA_ESTIMATE;
    run.config.camera.sigma_focal = 0.005;
    run.config.camera.sigma_aspect = 0.001;
    TEST_ASSERT_EQUAL_INT(error > 0 ? 1 : 0, warnings(run, 150, count_lens_warnings));
  }
}

/// Residuals are those of the lens as it is known after the update, not of the calibration that was given: the noise is that of a right
/// calibration.
void test_noise_should_be_that_of_the_right_calibration_when_a_wrong_one_is_estimated() {
  RenderedRun right("desk", 150, Start::kNone), wrong("desk", 150, Start::kNone);
  wrong.config.camera.fx *= 1.02;
  wrong.config.camera.fy *= 1.02;
  wrong.config.camera.estimate = PF_CAMERA_ESTIMATE;
  wrong.config.camera.sigma_focal = 0.01;
  wrong.config.camera.sigma_aspect = 0.001;
  TEST_ASSERT_EQUAL_INT(0, warnings(right, 150));
  TEST_ASSERT_EQUAL_INT(0, warnings(wrong, 150));
  TEST_ASSERT_DOUBLE_WITHIN(0.25 * right.frames.back().report.sigma_gate_px, right.frames.back().report.sigma_gate_px,
                            wrong.frames.back().report.sigma_gate_px);
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_log_should_not_warn_and_noise_should_be_plausible_when_the_calibration_is_right);
  RUN_TEST(test_log_should_warn_once_when_the_lens_is_wrong);
  RUN_TEST(test_log_should_warn_once_when_the_estimated_lens_leaves_its_prior);
  RUN_TEST(test_noise_should_be_that_of_the_right_calibration_when_a_wrong_one_is_estimated);
  return UNITY_END();
}
