/* The calibration as a part of the state: what pf_get_camera says of it when it is exact, considered and estimated. */
#include <math.h>
#include <planefold/planefold_research.h>

#include "small_context.h"

#define FRAMES 60
#define FOCAL_ERROR 0.01

static pf_camera_t known;
static double covariance[100];

/* A context that takes its calibration as `estimate` says, with k1 uncertain, in a block of its own. */
static unsigned char* open_with(int32_t estimate, pf_slam_t** to) {
  pf_config_t own = config;
  own.camera.estimate = estimate;
  own.camera.sigma_focal = 0.01;
  own.camera.sigma_aspect = 0.001;
  own.camera.sigma_centre_px = 1.6;
  own.camera.sigma_distortion[0] = 0.05;
  own.camera.fx *= 1 + FOCAL_ERROR;
  own.camera.fy *= 1 + FOCAL_ERROR;
  pf_memory_t bytes;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&own, &bytes));
  unsigned char* at = new_block(bytes.bytes, 0);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&own, at, bytes.bytes, to));
  return at;
}

static double sigma(int i) { return sqrt(covariance[11 * i]); }

static void require_prior(void) {
  const double focal = config.camera.fx * (1 + FOCAL_ERROR), relative = sqrt(0.01 * 0.01 + 0.001 * 0.001 / 4);
  TEST_ASSERT_DOUBLE_WITHIN(1e-4 * focal * relative, focal * relative, sigma(0));
  TEST_ASSERT_DOUBLE_WITHIN(1e-4 * focal * relative, focal * relative, sigma(1));
  TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1.6, sigma(2));
  TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1.6, sigma(3));
  TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.05, sigma(4));
  const double between = covariance[0] + covariance[11] - 2 * covariance[1]; /* of fx - fy */
  TEST_ASSERT_DOUBLE_WITHIN(1e-3 * focal * 0.001, focal * 0.001, sqrt(between));
  for (int i = 5; i < 10; ++i) TEST_ASSERT_EQUAL_DOUBLE(0, sigma(i));
}

static void test_an_exact_calibration_should_be_the_one_that_was_given(void) {
  run(slam, 10);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_camera(slam, &known, covariance));
  TEST_ASSERT_EQUAL_MEMORY(&config.camera, &known, sizeof known);
  for (int i = 0; i < 100; ++i) TEST_ASSERT_EQUAL_DOUBLE(0, covariance[i]);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_camera(slam, &known, NULL));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_camera(slam, NULL, covariance));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_get_camera(NULL, &known, covariance));
}

static void test_a_considered_calibration_should_keep_its_numbers_and_its_prior(void) {
  pf_slam_t* considered;
  unsigned char* at = open_with(PF_CAMERA_CONSIDER, &considered);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_camera(considered, &known, covariance));
  require_prior();
  run(considered, FRAMES);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_camera(considered, &known, covariance));
  require_prior();
  TEST_ASSERT_DOUBLE_WITHIN(1e-4, config.camera.fx * (1 + FOCAL_ERROR), known.fx);
  TEST_ASSERT_DOUBLE_WITHIN(1e-5, config.camera.cy, known.cy);
  pf_report_t report, exact;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(considered, &report));
  run(slam, FRAMES);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(slam, &exact));
  TEST_ASSERT_EQUAL_INT(exact.state_dim_held + 5, report.state_dim_held);
  free_block(at);
}

static void test_an_estimated_calibration_should_become_better_known_and_a_reset_should_forget_that(void) {
  pf_slam_t* estimated;
  unsigned char* at = open_with(PF_CAMERA_ESTIMATE, &estimated);
  run(estimated, FRAMES);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_camera(estimated, &known, covariance));
  const double truth[5] = {config.camera.fx, config.camera.fy, config.camera.cx, config.camera.cy, 0};
  const double now[5] = {known.fx, known.fy, known.cx, known.cy, known.distortion[0]};
  TEST_ASSERT_EQUAL_INT(PF_CAMERA_RADTAN, known.model);
  TEST_ASSERT_TRUE(sigma(4) < 0.04);
  for (int i = 0; i < 5; ++i) TEST_ASSERT_TRUE(fabs(now[i] - truth[i]) < 3 * sigma(i));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(estimated));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_camera(estimated, &known, covariance));
  require_prior();
  free_block(at);
}

/* Its row has a variance of zero: 1e-400 in double, 1e-60 in float. */
static void test_a_coefficient_as_good_as_exact_should_leave_what_is_known_about_the_gauge(void) {
  const double sigmas[2] = {1e-30, 1e-200};
  for (int i = 0; i < 2; ++i) {
    pf_memory_t bytes;
    pf_report_t report;
    pf_slam_t* own;
    double information[49];
    config.camera.model = PF_CAMERA_RADTAN;
    config.camera.estimate = PF_CAMERA_ESTIMATE;
    config.camera.sigma_focal = 0.01;
    config.camera.sigma_aspect = 0.001;
    config.camera.sigma_centre_px = 1.6;
    config.camera.sigma_distortion[0] = 0.05;
    config.camera.sigma_distortion[1] = sigmas[i];
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &bytes));
    unsigned char* at = new_block(bytes.bytes, 0);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, at, bytes.bytes, &own));
    run(own, 10);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(own, &report));
    const size_t rows = (size_t)report.state_dim;
    double* scratch = (double*)malloc(rows * (rows + 8) * sizeof *scratch);
    TEST_ASSERT_NOT_NULL(scratch);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_gauge_information(own, scratch, rows * (rows + 8), information));
    for (int k = 0; k < 49; ++k) TEST_ASSERT_TRUE(isfinite(information[k]));
    free(scratch);
    free_block(at);
  }
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_an_exact_calibration_should_be_the_one_that_was_given);
  RUN_TEST(test_a_considered_calibration_should_keep_its_numbers_and_its_prior);
  RUN_TEST(test_an_estimated_calibration_should_become_better_known_and_a_reset_should_forget_that);
  RUN_TEST(test_a_coefficient_as_good_as_exact_should_leave_what_is_known_about_the_gauge);
  return UNITY_END();
}
