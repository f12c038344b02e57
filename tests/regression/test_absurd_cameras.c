/* Calibrations and points that no device has: an answer that is accepted is a finite one. */
#include <float.h>
#include <math.h>
#include <planefold/planefold.h>
#include <stdio.h>
#include <string.h>
#include <unity.h>

#include "support/fake_time.h"

void setUp(void) {}
void tearDown(void) {}

enum { kTries = 100000 };

static double absurd(fake_random_t* random) {
  static const double values[] = {0.0, 5e-324, DBL_MIN, DBL_MAX, -DBL_MAX, 1e-30, 1e30, -1.0, 1e-9, 1e150, 1e37, 1.0};
  return values[fake_random_below(random, (int)(sizeof(values) / sizeof(values[0])))];
}

static void test_projection_should_be_finite_when_it_is_accepted(void) {
  fake_random_t random = {1};
  int accepted = 0;
  for (int i = 0; i < kTries; ++i) {
    pf_camera_t camera;
    double point[3], pixel[2] = {7, 7}, ray[3];
    pf_status_t status;
    memset(&camera, 0, sizeof(camera));
    camera.model = (pf_camera_model_t)(1 + fake_random_below(&random, 4));
    camera.width = 320;
    camera.height = 240;
    camera.fx = camera.fy = 280;
    camera.cx = 160;
    camera.cy = 120;
    for (int k = 0; k < 5; ++k) camera.distortion[k] = fake_random_below(&random, 3) == 0 ? absurd(&random) : 0.0;
    for (int k = 0; k < 3; ++k) point[k] = absurd(&random);
    status = pf_camera_project(&camera, point, pixel);
    if (status == PF_OK) {
      char line[160];
      snprintf(line, sizeof(line), "model %d, distortion %g %g %g %g %g, point %g %g %g", (int)camera.model,
               camera.distortion[0], camera.distortion[1], camera.distortion[2], camera.distortion[3],
               camera.distortion[4], point[0], point[1], point[2]);
      TEST_ASSERT_TRUE_MESSAGE(isfinite(pixel[0]) && isfinite(pixel[1]), line);
      ++accepted;
    } else {
      TEST_ASSERT_DOUBLE_WITHIN(0, 7, pixel[0]);
      TEST_ASSERT_DOUBLE_WITHIN(0, 7, pixel[1]);
    }
    for (int k = 0; k < 2; ++k) pixel[k] = absurd(&random);
    if (pf_camera_unproject(&camera, pixel, ray) == PF_OK) {
      TEST_ASSERT_TRUE(fabs(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2] - 1.0) < 1e-4);
    }
  }
  printf("%d of %d accepted, seed 1\n", accepted, kTries);
  TEST_ASSERT_GREATER_THAN_INT(kTries / 100, accepted);
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_projection_should_be_finite_when_it_is_accepted);
  return UNITY_END();
}
