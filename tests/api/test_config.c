/* Every field of the config: its default works, and a bad value is refused by name. */
#include <math.h>
#include <planefold/planefold.h>

#include "small_context.h"

static void names(pf_status_t status, const char* expected) {
  const char* field = "unset";
  TEST_ASSERT_EQUAL_INT_MESSAGE(status, pf_config_check(&config, &field), expected);
  TEST_ASSERT_EQUAL_STRING(expected, field);
  TEST_ASSERT_EQUAL_INT_MESSAGE(status, pf_config_check(&config, NULL), expected);
  TEST_ASSERT_EQUAL_INT_MESSAGE(status, pf_memory_query(&config, &need), expected);
}

/* One field at a value at a time, with everything else good. */
#define NAMES(field, value)           \
  do {                                \
    const pf_config_t good_ = config; \
    config.field = value;             \
    names(PF_ERROR_CONFIG, #field);   \
    config = good_;                   \
  } while (0)
#define NAMES_REAL(field, low, high) \
  do {                               \
    NAMES(field, low);               \
    NAMES(field, high);              \
    NAMES(field, NAN);               \
    NAMES(field, INFINITY);          \
    NAMES(field, -INFINITY);         \
  } while (0)

static void test_check_should_say_nothing_when_the_config_is_good(void) {
  const char* field = "unset";
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, &field));
  TEST_ASSERT_NULL(field);
}

static void test_check_should_name_the_field_that_is_out_of_range(void) {
  NAMES(max_state_dim, 31);
  NAMES(max_state_dim, 2001);
  NAMES(max_features, 7);
  NAMES(max_features, 1001);
  NAMES(max_observations, 7);
  NAMES(max_observations, 201);
  NAMES(features_in_view, 7);
  NAMES(features_in_view, 31); /* more than max_observations */
  NAMES(border_px, 3);
  NAMES(border_px, 65);
  NAMES(motion, 0);
  NAMES(motion, 3);
  NAMES(keep_gauge, 2);
  NAMES(depth_from_map, 2);
  NAMES(kernels, 99);
  NAMES_REAL(linear_acceleration_density, 0, 1e5);
  NAMES_REAL(angular_acceleration_density, 0, 1e5);
  NAMES_REAL(linear_walk, -1, 1e5);
  NAMES_REAL(angular_walk, -1, 1e5);
  NAMES_REAL(sigma_pixel, 0.009, 10.1);
  NAMES_REAL(gate_probability, 0.89, 1);
  NAMES_REAL(start_depth, 0, 1e9);
  NAMES_REAL(inverse_depth_relative_sigma, 0.04, 5.1);
  NAMES_REAL(linearity_index, 0.0009, 1.1);
  NAMES_REAL(coast_seconds, 0.04, 10.1);
  NAMES(imu_buffer, -1);
  NAMES(imu_buffer, 10001);
  NAMES_REAL(imu_gyro_range, -1, 1001);
  NAMES_REAL(imu_accel_range, -1, 1.1e5);
}

#define NAMES_CAMERA(field, value)    \
  do {                                \
    const pf_config_t good_ = config; \
    config.camera.field = value;      \
    names(PF_ERROR_CONFIG, #field);   \
    config = good_;                   \
  } while (0)

static void test_check_should_name_the_number_of_the_camera_that_makes_no_sense(void) {
  NAMES_CAMERA(model, 0);
  NAMES_CAMERA(model, 5);
  NAMES_CAMERA(width, 31);
  NAMES_CAMERA(width, 4097);
  NAMES_CAMERA(height, 31);
  NAMES_CAMERA(height, 4097);
  NAMES_CAMERA(fx, 0);
  NAMES_CAMERA(fx, NAN);
  NAMES_CAMERA(fy, -100);
  NAMES_CAMERA(fy, INFINITY);
  NAMES_CAMERA(cx, NAN);
  NAMES_CAMERA(cx, 1e6);
  NAMES_CAMERA(cy, -1e6);
  NAMES_CAMERA(readout_s, -0.001);
  NAMES_CAMERA(readout_s, 0.201);
  NAMES_CAMERA(readout_s, NAN);
  config.motion = PF_MOTION_CONSTANT_POSITION; /* rows cannot differ without a speed */
  NAMES_CAMERA(readout_s, 0.03);
  config.motion = PF_MOTION_CONSTANT_VELOCITY;
  config.camera.readout_s = 0.03;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL));
  config.camera.readout_s = 0;
  config.camera.distortion[0] = 0.1; /* a pinhole has none */
  names(PF_ERROR_CONFIG, "distortion");
  config.camera.model = PF_CAMERA_RADTAN;
  config.camera.distortion[0] = NAN;
  names(PF_ERROR_CONFIG, "distortion");
}

static void test_check_should_tell_another_release_or_library_by_size_version_and_scalar(void) {
  config.size -= 8;
  names(PF_ERROR_VERSION, "size");
  config.size += 8;
  config.version += 1;
  names(PF_ERROR_VERSION, "version");
  config.version -= 1;
  config.scalar = config.scalar == PF_SCALAR_DOUBLE ? PF_SCALAR_FLOAT : PF_SCALAR_DOUBLE;
  names(PF_ERROR_SCALAR, "scalar");
}

static void test_every_status_should_have_a_line_of_text(void) {
  for (int status = -20; status <= 10; ++status) {
    const char* text = pf_status_text((pf_status_t)status);
    TEST_ASSERT_NOT_NULL(text);
    TEST_ASSERT_NULL(strchr(text, '\n'));
    if (status >= PF_ERROR_CONTEXT && status <= PF_NOTE_TRUNCATED)
      TEST_ASSERT_TRUE(strcmp(text, pf_status_text((pf_status_t)100)) != 0);
  }
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_check_should_say_nothing_when_the_config_is_good);
  RUN_TEST(test_check_should_name_the_field_that_is_out_of_range);
  RUN_TEST(test_check_should_name_the_number_of_the_camera_that_makes_no_sense);
  RUN_TEST(test_check_should_tell_another_release_or_library_by_size_version_and_scalar);
  RUN_TEST(test_every_status_should_have_a_line_of_text);
  return UNITY_END();
}
