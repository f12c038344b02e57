/* No feature has been seen more often than it was looked for: also where a frame contradicts its inertial samples and is measured again
 * without them, and where the window finds too few features for its pose. */
#include <stdio.h>

#include "support/inertial_unit.h"
#include "support/small_context.h"

#define IMU_NS INT64_C(5000000)

static uint64_t state;

/* -1 .. 1 */
static double uniform(void) {
  state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (double)(state >> 33) / 1073741824.0 - 1.0;
}

static void use_inertial_model(void) {
  use_inertial_unit(&config, 100);
  config.capacity.max_observations = config.map.features_in_view = 8;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
  free_block(block);
  block = new_block(need.bytes, 0x55);
}

static void require_counts(unsigned seed, int frame) {
  pf_feature_t features[120];
  size_t count = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_features(slam, features, 120, &count));
  for (size_t i = 0; i < count; ++i) {
    char line[120];
    snprintf(line, sizeof(line), "seed %u, frame %d: feature %u seen %d times of %d", seed, frame, features[i].id,
             features[i].observations, features[i].attempts);
    TEST_ASSERT_TRUE_MESSAGE(features[i].observations <= features[i].attempts, line);
  }
}

static void test_a_frame_that_is_measured_again_should_count_once(void) {
  use_inertial_model();
  for (unsigned seed = 1; seed <= 40; ++seed) {
    int64_t sample_ns = 0;
    state = seed;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, need.bytes, &slam));
    for (int k = 0; k < 100; ++k) {
      const double wrong = k > 45 && k % 4 == 0 ? uniform() : 0; /* [rad/s] */
      for (; sample_ns <= STEP_NS * k; sample_ns += IMU_NS) {
        const pf_imu_sample_t sample = {sample_ns, {0, wrong, 0}, {0, -9.81, 0}};
        TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_imu(slam, &sample, 1));
      }
      pf_observation_t seen[POINTS];
      const size_t count = observe(0, seen);
      for (size_t i = 0; i < count && k > 45; ++i)
        if (uniform() > 0.3) seen[i].pixel[0] += 6 * uniform();
      TEST_ASSERT_TRUE(pf_push_observations(slam, STEP_NS * k, seen, count) >= PF_OK);
      require_counts(seed, k);
    }
  }
}

static double grey_at(int column, int row) {
  uint32_t h = (uint32_t)column * 2654435761u ^ (uint32_t)row * 40503u;
  h = (h ^ h >> 15) * 2246822519u;
  return (double)(h >> 24);
}

/* Grey levels at the corners of cells of 5 px, and between them in proportion. */
static double texture(double x, double y) {
  const double u = x / 5, v = y / 5;
  const int i = (int)u, j = (int)v;
  const double a = u - i, b = v - j;
  return (1 - b) * ((1 - a) * grey_at(i, j) + a * grey_at(i + 1, j)) +
         b * ((1 - a) * grey_at(i, j + 1) + a * grey_at(i + 1, j + 1));
}

/* A wall and stripes before it, seen by a camera that moves sideways; beyond `shown` columns everything is grey. */
static void paint(double shift_px, int shown) {
  for (int y = 0; y < HEIGHT; ++y)
    for (int x = 0; x < WIDTH; ++x) {
      const int is_near = y / 20 % 2;
      const double grey = texture(x + (is_near ? 1 : 0.5) * shift_px + (is_near ? 5000 : 9000), y);
      pixels[y * WIDTH + x] = (uint8_t)(x < shown ? grey : 128);
    }
}

/* Motion that is known far too well, so that the pose follows late and fewer matches than it took are inliers at last. */
static void test_a_frame_that_does_not_support_the_window_s_pose_should_count_what_it_takes(void) {
  config.backend = PF_BACKEND_WINDOW;
  config.window.points = 102;
  config.window.keyframes = 7;
  config.window.fixed_keyframes = 6;
  config.map.features_in_view = 26;
  config.measurement.gate_probability = 0.917593;
  config.measurement.sigma_px = 0.0217054;
  config.motion.linear_acceleration_density = 1.284e-05;
  config.motion.angular_acceleration_density = 0.00055091;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
  free_block(block);
  block = new_block(need.bytes, 0x55);
  for (unsigned seed = 140; seed <= 150; ++seed) {
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, need.bytes, &slam));
    state = seed;
    for (int k = 0; k < 100; ++k) {
      const int more = k > 50 ? k - 50 : 0;
      paint(1.24736 * k + 0.0446243 * more * more, k > 50 && k % 7 < 3 ? 16 + (int)(50 + 50 * uniform()) : WIDTH);
      const pf_image_t image = {pixels, WIDTH, HEIGHT, WIDTH, STEP_NS * (k + 1)};
      TEST_ASSERT_TRUE(pf_push_frame(slam, &image) >= PF_OK);
      require_counts(seed, k);
    }
  }
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_a_frame_that_is_measured_again_should_count_once);
  RUN_TEST(test_a_frame_that_does_not_support_the_window_s_pose_should_count_what_it_takes);
  return UNITY_END();
}
