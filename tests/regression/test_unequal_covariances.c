/* A position that is known much worse than the points are known about the camera: what an image is expected to show is a difference of
 * large numbers, of which rounding leaves nothing at last. Every covariance that is given stays one. */
#include <math.h>
#include <stdio.h>

#include "support/small_context.h"

static void require_covariances(double sigma, int frame) {
  pf_match_t matches[64];
  size_t count = 0;
  TEST_ASSERT_TRUE(pf_get_matches(slam, matches, 64, &count) >= PF_OK);
  for (size_t i = 0; i < count; ++i) {
    const double* S = matches[i].covariance_px;
    char line[160];
    snprintf(line, sizeof(line), "sigma %g, frame %d, match %u: %g %g %g", sigma, frame, matches[i].id, S[0], S[1],
             S[3]);
    TEST_ASSERT_TRUE_MESSAGE(isfinite(S[0]) && isfinite(S[3]) && S[0] >= 0 && S[3] >= 0, line);
    TEST_ASSERT_TRUE_MESSAGE(fabs(S[1]) <= sqrt(S[0]) * sqrt(S[3]) * (1 + 1e-6), line);
  }
}

static void test_matches_should_have_covariances_when_the_position_is_hardly_known(void) {
  const double largest = config.scalar == PF_SCALAR_FLOAT ? 1e3 : 1e6;
  int known = 0;
  for (double sigma = 1e-3 * largest; sigma < 1.01 * largest; sigma *= 10) {
    pf_pose_t pose;
    double velocity_covariance[36] = {0};
    memset(&pose, 0, sizeof(pose));
    pose.q_WC[0] = 1;
    for (int i = 0; i < 3; ++i) {
      pose.covariance[7 * i] = 1e-4;
      pose.covariance[7 * (i + 3)] = sigma * sigma;
      velocity_covariance[7 * i] = velocity_covariance[7 * (i + 3)] = 1e-4;
    }
    config.first_depth.depth = 0.05;
    config.measurement.sigma_px = 0.02;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, need.bytes, &slam));
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_pose(slam, &pose, velocity_covariance));
    for (int k = 0; k < 40; ++k) {
      pf_observation_t seen[POINTS];
      const size_t count = observe(k, seen);
      for (size_t i = 0; i < count; ++i) {
        const double p_C[3] = {(-0.9 + 0.36 * ((int)i % 6)) / 50 - 4e-4 * k, (-0.6 + 0.4 * ((int)i / 6)) / 50,
                               i % 2 ? 0.04 : 0.06};
        TEST_ASSERT_EQUAL_INT(PF_OK, pf_camera_project(&config.camera, p_C, seen[i].pixel));
      }
      const pf_status_t status = pf_push_observations(slam, (k + 1) * STEP_NS, seen, count);
      TEST_ASSERT_TRUE(status >= PF_OK);
      known += status == PF_OK ? 1 : 0;
      require_covariances(sigma, k);
    }
  }
  TEST_ASSERT_GREATER_THAN_INT(0, known);
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_matches_should_have_covariances_when_the_position_is_hardly_known);
  return UNITY_END();
}
