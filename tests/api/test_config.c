/* Every field of the config: its default works, and a bad value is refused by name. */
#include <math.h>
#include <planefold/planefold_research.h>

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

static void allow_research(void) {
  pf_research_t research;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_research_default(&research));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_set_research(&config, &research));
}

static void test_forms_for_comparison_should_be_refused_by_name_without_research(void) {
  NAMES(motion.model, PF_MOTION_CONSTANT_POSITION);
  NAMES(plane.fix, PF_FIX_ERROR_FREE);
  NAMES(map.masks, PF_MASKS_WHOLE);
  allow_research();
  config.motion.model = PF_MOTION_CONSTANT_POSITION;
  config.plane.fix = PF_FIX_ERROR_FREE;
  config.map.masks = PF_MASKS_WHOLE;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_set_research(&config, NULL));
  names(PF_ERROR_CONFIG, "motion.model");
}

#define NAMES_RESEARCH(field, value)                                           \
  do {                                                                         \
    pf_research_t research_;                                                   \
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_research_default(&research_));             \
    research_.field = value;                                                   \
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_set_research(&config, &research_)); \
    names(PF_ERROR_CONFIG, "research." #field);                                \
  } while (0)

static void test_check_should_name_the_field_of_research_that_is_out_of_range(void) {
  NAMES_RESEARCH(keep_gauge, 2);
  NAMES_RESEARCH(keep_gauge, -1);
  NAMES_RESEARCH(fold, 0);
  NAMES_RESEARCH(fold, 3);
  NAMES_RESEARCH(linear_walk, 0);
  NAMES_RESEARCH(gate_patches, 2);
  NAMES_RESEARCH(linear_walk, NAN);
  NAMES_RESEARCH(angular_walk, 1e5);
  NAMES_RESEARCH(angular_walk, -INFINITY);
}

static void test_research_of_another_release_should_be_refused(void) {
  pf_research_t research;
  allow_research();
  config.research[0] ^= 1;
  names(PF_ERROR_VERSION, "research");
  TEST_ASSERT_EQUAL_INT(PF_ERROR_VERSION, pf_config_get_research(&config, &research));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_config_set_research(NULL, &research));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_config_get_research(&config, NULL));
  TEST_ASSERT_EQUAL_INT(PF_ERROR_NULL, pf_research_default(NULL));
}

static void test_check_should_say_nothing_when_the_config_is_good(void) {
  const char* field = "unset";
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, &field));
  TEST_ASSERT_NULL(field);
}

static void test_check_should_name_the_field_that_is_out_of_range(void) {
  NAMES(capacity.max_state_dim, 31);
  NAMES(capacity.max_state_dim, 2001);
  NAMES(capacity.max_features, 7);
  NAMES(capacity.max_features, 1001);
  NAMES(capacity.max_observations, 7);
  NAMES(capacity.max_observations, 201);
  NAMES(backend, 0);
  NAMES(backend, 3);
  NAMES(window.keyframes, 1);
  NAMES(window.keyframes, 9);
  NAMES(window.fixed_keyframes, -1);
  NAMES(window.fixed_keyframes, 17);
  NAMES(window.points, 49);
  NAMES(window.points, 1001);
  NAMES(map.features_in_view, 7);
  NAMES(map.features_in_view, 31); /* more than max_observations */
  NAMES(map.border_px, 3);
  NAMES(map.border_px, 65);
  NAMES(motion.model, 0);
  NAMES(motion.model, 5);
  NAMES(first_depth.from_map, 2);
  NAMES(first_depth.from_map, -1);
  NAMES(plane.enabled, 2);
  NAMES(plane.enabled, -1);
  NAMES(plane.fix, 0);
  NAMES(plane.fix, 4);
  NAMES(plane.min_points, 3);
  NAMES(plane.min_points, 61);
  NAMES(capacity.max_planes, 0);
  NAMES(capacity.max_planes, 65);
  NAMES(kernels, -1);
  NAMES(kernels, 99);
  NAMES_REAL(motion.linear_acceleration_density, 0, 1e5);
  NAMES_REAL(motion.linear_jerk_density, 0, 1e6);
  NAMES_REAL(motion.angular_acceleration_density, 0, 1e5);
  NAMES_REAL(measurement.sigma_px, 0.009, 10.1);
  NAMES_REAL(measurement.gate_probability, 0.89, 1);
  NAMES_REAL(first_depth.depth, 0, 1e9);
  NAMES_REAL(first_depth.relative_sigma, 0.04, 5.1);
  NAMES_REAL(first_depth.linearity_index, 0.0009, 1.1);
  NAMES_REAL(motion.coast_s, 0.04, 10.1);
  NAMES_REAL(motion.restart_s, -1, 1.1e4);
  NAMES_REAL(plane.max_distance, 0, 10.1);
  NAMES_REAL(plane.max_radius, 0.009, 1.1e4);
  NAMES_REAL(plane.roughness, 0, 1.1);
  NAMES_REAL(plane.fold_sigma, 0, 10.1);
  NAMES_REAL(plane.fix_sigma, -1, 10.1);
  NAMES(capacity.max_kept_views, -1);
  NAMES(capacity.max_kept_views, 201);
  NAMES(capacity.max_places, -2);
  NAMES(capacity.max_places, 201);
  NAMES(capacity.max_anchors, -1);
  NAMES(capacity.max_anchors, 65);
  NAMES(capacity.max_patches, -1);
  NAMES(capacity.max_patches, 33);
  NAMES(capacity.patch_side_px, 31);
  NAMES(capacity.patch_side_px, 129);
  NAMES(capacity.max_cameras, -1);
  NAMES(capacity.max_cameras, 65);
  NAMES(map.features_in_view, 0); /* without patches */
  NAMES(capacity.max_imu_samples, -1);
  NAMES(capacity.max_imu_samples, 10001);
  NAMES_REAL(imu.gyro_range, -1, 1001);
  NAMES_REAL(imu.accel_range, -1, 1.1e5);
}

static void test_patches_should_take_at_most_24_kib_each_and_nothing_where_there_are_none(void) {
  pf_memory_t none, one, three;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &none));
  config.capacity.patch_side_px = 64;
  config.capacity.max_cameras = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &one));
  TEST_ASSERT_EQUAL_size_t(none.bytes, one.bytes);
  config.capacity.max_patches = 1;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &one));
  config.capacity.max_patches = 3;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &three));
  TEST_ASSERT_TRUE(three.bytes > one.bytes && three.bytes - one.bytes <= 2 * 24 * 1024);
  config.map.features_in_view = 0; /* patches alone */
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL));
  config.map.features_in_view = 7;
  names(PF_ERROR_CONFIG, "map.features_in_view");
}

static void test_check_should_name_what_the_inertial_model_lacks(void) {
  config.motion.model = PF_MOTION_INERTIAL;
  names(PF_ERROR_CONFIG, "capacity.max_imu_samples");
  config.capacity.max_imu_samples = 63;
  names(PF_ERROR_CONFIG, "capacity.max_imu_samples");
  config.capacity.max_imu_samples = 64;
  names(PF_ERROR_CONFIG, "imu.gyro_density"); /* no default fits a unit */
  config.imu.gyro_density = 2e-4;
  names(PF_ERROR_CONFIG, "imu.accel_density");
  config.imu.accel_density = 2e-3;
  names(PF_ERROR_CONFIG, "imu.gyro_walk");
  config.imu.gyro_walk = 2e-5;
  names(PF_ERROR_CONFIG, "imu.accel_walk");
  config.imu.accel_walk = 3e-3;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL));
  NAMES_REAL(imu.gyro_density, 0, 1.1);
  NAMES_REAL(imu.accel_density, -1, 10.1);
  NAMES_REAL(imu.gyro_walk, 0, 1.1);
  NAMES_REAL(imu.accel_walk, 0, 10.1);
  NAMES_REAL(imu.delay_s, -0.51, 0.51);
  NAMES_REAL(imu.gravity, 8.9, 11.1);
  NAMES_REAL(imu.sigma_mount_rad, -1e-3, 4.1);
  NAMES_REAL(imu.sigma_mount_m, -1e-3, 1.1);
  NAMES_REAL(imu.sigma_delay_s, -1e-3, 0.21);
  NAMES_REAL(imu.sigma_scale, -1e-3, 0.06);
  NAMES(imu.sigma_delay_s, 1e-9); /* less than float can hold */
  config.imu.sigma_mount_rad = config.imu.sigma_mount_m = 0.02;
  config.imu.sigma_delay_s = 0.01;
  NAMES_REAL(imu.sigma_readout_s, -1e-3, 0.11);
  config.imu.sigma_readout_s = 1e-3; /* also of rows of which nothing else is known */
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL));
  config.imu.sigma_readout_s = 0;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL));
  const int32_t rows = config.capacity.max_state_dim;
  config.capacity.max_state_dim = 32; /* the body alone has 24 */
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL));
  config.camera.estimate = PF_CAMERA_ESTIMATE;
  config.camera.sigma_focal = 0.01;
  config.camera.sigma_aspect = 0.001;
  config.camera.sigma_centre_px = 5;
  names(PF_ERROR_CONFIG, "capacity.max_state_dim");
  config.camera.estimate = PF_CAMERA_EXACT;
  config.capacity.max_state_dim = rows;
  config.imu.p_BC[1] = 11;
  names(PF_ERROR_CONFIG, "imu.p_BC");
  config.imu.p_BC[1] = NAN;
  names(PF_ERROR_CONFIG, "imu.p_BC");
  config.imu.p_BC[1] = 0;
  config.imu.q_BC[0] = 0.9; /* no rotation */
  names(PF_ERROR_CONFIG, "imu.q_BC");
  config.imu.q_BC[0] = NAN;
  names(PF_ERROR_CONFIG, "imu.q_BC");
  config.motion.model = PF_MOTION_CONSTANT_VELOCITY; /* which reads none of it */
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL));
}

static void test_check_should_name_the_number_of_the_camera_that_makes_no_sense(void) {
  NAMES(camera.model, 0);
  NAMES(camera.model, 5);
  NAMES(camera.width, 31);
  NAMES(camera.width, 4097);
  NAMES(camera.height, 31);
  NAMES(camera.height, 4097);
  NAMES(camera.fx, 0);
  NAMES(camera.fx, NAN);
  NAMES(camera.fy, -100);
  NAMES(camera.fy, INFINITY);
  NAMES(camera.cx, NAN);
  NAMES(camera.cx, 1e6);
  NAMES(camera.cy, -1e6);
  NAMES(camera.readout_s, -0.001);
  NAMES(camera.readout_s, 0.201);
  NAMES(camera.readout_s, NAN);
  NAMES(camera.timestamps, -1);
  NAMES(camera.timestamps, 2);
  config.camera.timestamps = PF_TIMESTAMPS_NOMINAL;
  config.camera.readout_s = 0.03; /* counts as 0 */
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL));
  config.camera.timestamps = PF_TIMESTAMPS_REAL;
  config.camera.readout_s = 0;
  allow_research();
  config.motion.model = PF_MOTION_CONSTANT_POSITION; /* rows cannot differ without a speed */
  NAMES(camera.readout_s, 0.03);
  config.motion.model = PF_MOTION_CONSTANT_VELOCITY;
  config.camera.readout_s = 0.03;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL));
  config.camera.readout_s = 0;
  config.camera.distortion[0] = 0.1; /* a pinhole has none */
  names(PF_ERROR_CONFIG, "camera.distortion");
  config.camera.model = PF_CAMERA_RADTAN;
  config.camera.distortion[0] = NAN;
  names(PF_ERROR_CONFIG, "camera.distortion");
}

static void test_check_should_name_the_sigma_of_the_camera_that_makes_no_sense(void) {
  NAMES(camera.estimate, -1);
  NAMES(camera.estimate, 3);
  config.camera.sigma_focal = config.camera.sigma_aspect = config.camera.sigma_centre_px = -1;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL)); /* nobody asks for them */
  for (int32_t estimate = PF_CAMERA_CONSIDER; estimate <= PF_CAMERA_ESTIMATE; ++estimate) {
    config.camera.estimate = estimate;
    config.camera.sigma_focal = 0.01;
    config.camera.sigma_aspect = 0.001;
    config.camera.sigma_centre_px = 3.2;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL));
    NAMES_REAL(camera.sigma_focal, 0, 0.3);
    NAMES(camera.sigma_focal, -0.01);
    NAMES_REAL(camera.sigma_aspect, 0, 0.3);
    NAMES_REAL(camera.sigma_centre_px, 0, 1001);
    const double bad[] = {-0.01, 1.1, NAN, INFINITY};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
      config.camera.sigma_distortion[0] = bad[i];
      names(PF_ERROR_CONFIG, "camera.sigma_distortion");
    }
    config.camera.sigma_distortion[0] = 0.05; /* of a pinhole: k1 */
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL));
    config.camera.sigma_distortion[1] = 0.05; /* which has no other */
    names(PF_ERROR_CONFIG, "camera.sigma_distortion");
    config.camera.sigma_distortion[0] = config.camera.sigma_distortion[1] = 0;
  }
}

static void test_check_should_tell_another_release_or_library_by_size_version_and_scalar(void) {
  config.size -= 8;
  names(PF_ERROR_VERSION, "size");
  config.size += 8;
  config.scalar = config.scalar == PF_SCALAR_DOUBLE ? PF_SCALAR_FLOAT : PF_SCALAR_DOUBLE;
  names(PF_ERROR_SCALAR, "scalar");
}

static void test_a_patch_release_should_be_accepted_and_another_minor_or_major_refused(void) {
  const uint32_t minor = (uint32_t)1 << 8, major = (uint32_t)1 << 16;
  config.version = PF_VERSION ^ 7u;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_check(&config, NULL));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
  config.version = PF_VERSION + minor;
  names(PF_ERROR_VERSION, "version");
  config.version = PF_VERSION + major;
  names(PF_ERROR_VERSION, "version");
  config.version = 0;
  names(PF_ERROR_VERSION, "version");
}

static void test_version_should_be_that_of_the_library_and_of_a_new_config(void) {
  pf_config_default(&config);
  TEST_ASSERT_EQUAL_HEX32(PF_VERSION, pf_version());
  TEST_ASSERT_EQUAL_HEX32(pf_version(), config.version);
}

static void test_every_status_should_have_a_line_of_text(void) {
  for (int status = -20; status <= 10; ++status) {
    const char* text = pf_status_text((pf_status_t)status);
    TEST_ASSERT_NOT_NULL(text);
    TEST_ASSERT_NULL(strchr(text, '\n'));
    if (status >= PF_ERROR_FULL && status <= PF_NOTE_TRUNCATED)
      TEST_ASSERT_TRUE(strcmp(text, pf_status_text((pf_status_t)100)) != 0);
  }
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_forms_for_comparison_should_be_refused_by_name_without_research);
  RUN_TEST(test_check_should_name_the_field_of_research_that_is_out_of_range);
  RUN_TEST(test_research_of_another_release_should_be_refused);
  RUN_TEST(test_check_should_say_nothing_when_the_config_is_good);
  RUN_TEST(test_check_should_name_the_field_that_is_out_of_range);
  RUN_TEST(test_patches_should_take_at_most_24_kib_each_and_nothing_where_there_are_none);
  RUN_TEST(test_check_should_name_what_the_inertial_model_lacks);
  RUN_TEST(test_check_should_name_the_number_of_the_camera_that_makes_no_sense);
  RUN_TEST(test_check_should_name_the_sigma_of_the_camera_that_makes_no_sense);
  RUN_TEST(test_check_should_tell_another_release_or_library_by_size_version_and_scalar);
  RUN_TEST(test_a_patch_release_should_be_accepted_and_another_minor_or_major_refused);
  RUN_TEST(test_version_should_be_that_of_the_library_and_of_a_new_config);
  RUN_TEST(test_every_status_should_have_a_line_of_text);
  return UNITY_END();
}
