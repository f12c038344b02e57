/* Inertial samples at the door: what is refused, what is counted, what is kept, and which poses depend on them. */
#include <math.h>
#include <planefold/planefold.h>
#include <string.h>

#include "small_context.h"
#include "support/inertial_unit.h"

#define KEPT 8
#define IMU_NS INT64_C(5000000)

static const pf_imu_sample_t still = {0, {0.01, -0.02, 0.03}, {0.1, -9.8, 0.2}};

static pf_imu_sample_t at(int64_t t_ns) {
  pf_imu_sample_t sample = still;
  sample.t_ns = t_ns;
  return sample;
}

/* The context of setUp with a buffer and known ranges. */
static void use_buffer(void) {
  config.capacity.max_imu_samples = KEPT;
  config.imu.gyro_range = 10;
  config.imu.accel_range = 40;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
  free_block(block);
  block = new_block(need.bytes, 0x55);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, need.bytes, &slam));
}

static pf_imu_report_t report_of(void) {
  pf_imu_report_t report;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_imu_report(slam, &report));
  return report;
}

static void push_samples(int64_t from_ns, int64_t step_ns, int count) {
  for (int i = 0; i < count; ++i) {
    const pf_imu_sample_t sample = at(from_ns + step_ns * i);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_imu(slam, &sample, 1));
  }
}

static void test_samples_should_be_refused_whole_when_one_of_them_is_not_finite(void) {
  const double bad[3] = {NAN, INFINITY, -INFINITY};
  use_buffer();
  push_samples(IMU_NS, IMU_NS, 3);
  for (int b = 0; b < 3; ++b)
    for (int number = 0; number < 6; ++number) {
      pf_imu_sample_t samples[3] = {at(4 * IMU_NS), at(5 * IMU_NS), at(6 * IMU_NS)};
      (number < 3 ? samples[2].gyro : samples[2].accel)[number % 3] = bad[b];
      REFUSES(PF_ERROR_NONFINITE, pf_push_imu(slam, samples, 3));
    }
}

static void test_samples_should_be_refused_when_no_unit_could_have_measured_them(void) {
  pf_imu_sample_t samples[2] = {at(IMU_NS), at(2 * IMU_NS)};
  use_buffer();
  samples[1].gyro[2] = -1001;
  REFUSES(PF_ERROR_RANGE, pf_push_imu(slam, samples, 2));
  samples[1] = at(2 * IMU_NS);
  samples[1].accel[0] = 1.01e5;
  REFUSES(PF_ERROR_RANGE, pf_push_imu(slam, samples, 2));
  samples[1].accel[0] = 1e300;
  REFUSES(PF_ERROR_RANGE, pf_push_imu(slam, samples, 2));
}

static void test_samples_should_be_refused_when_time_stands_still_or_runs_back(void) {
  pf_imu_sample_t samples[3] = {at(4 * IMU_NS), at(5 * IMU_NS), at(5 * IMU_NS)};
  pf_imu_sample_t old = at(3 * IMU_NS);
  use_buffer();
  push_samples(IMU_NS, IMU_NS, 3);
  REFUSES(PF_ERROR_TIME, pf_push_imu(slam, samples, 3));
  samples[2].t_ns = 4 * IMU_NS;
  REFUSES(PF_ERROR_TIME, pf_push_imu(slam, samples, 3));
  REFUSES(PF_ERROR_TIME, pf_push_imu(slam, &old, 1));
  old.t_ns = INT64_MIN;
  REFUSES(PF_ERROR_TIME, pf_push_imu(slam, &old, 1));
  samples[2].t_ns = 6 * IMU_NS;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_imu(slam, samples, 3));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_imu(slam, NULL, 0));
  TEST_ASSERT_EQUAL_INT64(6, report_of().samples);
}

static void test_the_buffer_should_keep_the_newest_samples_in_order(void) {
  pf_imu_sample_t kept[KEPT];
  size_t count = 0;
  use_buffer();
  push_samples(IMU_NS, IMU_NS, 5);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_imu_samples(slam, kept, KEPT, &count));
  TEST_ASSERT_EQUAL_size_t(5, count);
  push_samples(6 * IMU_NS, IMU_NS, 2 * KEPT);
  TEST_ASSERT_EQUAL_INT(PF_NOTE_TRUNCATED, pf_get_imu_samples(slam, kept, 3, &count));
  TEST_ASSERT_EQUAL_size_t(KEPT, count);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_imu_samples(slam, kept, KEPT, &count));
  for (int i = 0; i < KEPT; ++i) {
    TEST_ASSERT_EQUAL_INT64((6 + KEPT + i) * IMU_NS, kept[i].t_ns);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, still.gyro[2], kept[i].gyro[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, still.accel[1], kept[i].accel[1]);
  }
  TEST_ASSERT_EQUAL_INT32(KEPT, report_of().kept);
  TEST_ASSERT_EQUAL_INT64(5 + 2 * KEPT, report_of().samples);
}

static void test_samples_should_be_counted_when_none_are_kept(void) {
  pf_memory_t without, with;
  size_t count = 1;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &without));
  push_samples(IMU_NS, IMU_NS, 20);
  TEST_ASSERT_EQUAL_INT64(20, report_of().samples);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_imu_samples(slam, NULL, 0, &count));
  TEST_ASSERT_EQUAL_size_t(0, count);
  config.capacity.max_imu_samples = 1000;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &with));
  TEST_ASSERT_GREATER_OR_EQUAL_size_t(without.bytes + 1000 * (8 + 6 * sizeof(float)), with.bytes);
}

static void test_the_report_should_tell_rate_and_gaps(void) {
  pf_imu_report_t report;
  push_samples(IMU_NS, IMU_NS, 1);
  TEST_ASSERT_EQUAL_DOUBLE(0, report_of().rate_hz);
  push_samples(2 * IMU_NS, IMU_NS, 99);
  report = report_of();
  TEST_ASSERT_DOUBLE_WITHIN(1e-6, 200, report.rate_hz);
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.005, report.median_s);
  TEST_ASSERT_EQUAL_INT64(0, report.gaps);
  push_samples(104 * IMU_NS, IMU_NS, 10); /* 101, 102 and 103 are not there */
  push_samples(1114 * IMU_NS, IMU_NS, 1); /* and a thousand more */
  report = report_of();
  TEST_ASSERT_EQUAL_INT64(2, report.gaps);
  TEST_ASSERT_EQUAL_INT64(3 + 1000, report.missing);
  TEST_ASSERT_EQUAL_INT64(1001 * IMU_NS, report.longest_ns);
  TEST_ASSERT_EQUAL_INT64(IMU_NS, report.first_t_ns);
  TEST_ASSERT_EQUAL_INT64(1114 * IMU_NS, report.last_t_ns);
  TEST_ASSERT_DOUBLE_WITHIN(0.001, 0.005, report.median_s);
  TEST_ASSERT_EQUAL_UINT32(0, report.used);
}

static void test_jitter_should_be_no_gap(void) {
  for (int i = 0; i < 200; ++i) {
    const pf_imu_sample_t sample = at(IMU_NS * (i + 1) + (i % 2 ? IMU_NS / 5 : 0));
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_imu(slam, &sample, 1));
  }
  TEST_ASSERT_EQUAL_INT64(0, report_of().gaps);
}

static void test_saturation_should_be_counted_when_the_ranges_are_known(void) {
  pf_imu_sample_t sample = at(IMU_NS);
  sample.gyro[1] = -10;
  sample.accel[2] = 40;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_imu(slam, &sample, 1));
  TEST_ASSERT_EQUAL_INT64(0, report_of().saturated);
  use_buffer();
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_imu(slam, &sample, 1));
  TEST_ASSERT_EQUAL_INT64(1, report_of().saturated);
  sample = at(2 * IMU_NS);
  sample.accel[2] = 39;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_imu(slam, &sample, 1));
  TEST_ASSERT_EQUAL_INT64(1, report_of().saturated);
}

static void test_samples_should_be_counted_between_frames(void) {
  run(slam, 1);
  push_samples(STEP_NS + 1, IMU_NS, 6);
  TEST_ASSERT_EQUAL_INT64(6, report_of().since_frame);
  TEST_ASSERT_TRUE(push(slam, 1) >= PF_OK);
  TEST_ASSERT_EQUAL_INT64(0, report_of().since_frame);
  TEST_ASSERT_EQUAL_INT64(6, report_of().last_frame);
  TEST_ASSERT_EQUAL_INT64(0, report_of().late);
  push_samples(2 * STEP_NS - 1000, 999, 3); /* two that should have come before the frame */
  TEST_ASSERT_EQUAL_INT64(2, report_of().late);
  REFUSES(PF_ERROR_TIME, push(slam, 1));
  TEST_ASSERT_EQUAL_INT64(3, report_of().since_frame);
}

static void test_extreme_times_should_neither_overflow_nor_stop_what_follows(void) {
  push_samples(INT64_MIN, 1, 3);
  const pf_imu_sample_t last = at(INT64_MAX);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_imu(slam, &last, 1));
  TEST_ASSERT_EQUAL_INT64(1, report_of().gaps);
  TEST_ASSERT_TRUE(isfinite(report_of().rate_hz));
  REFUSES(PF_ERROR_TIME, pf_push_imu(slam, &last, 1));
}

static void test_poses_should_be_the_same_with_and_without_samples(void) {
  pf_pose_t with, without;
  pf_feature_t features[2][30];
  size_t count[2];
  run(slam, 20);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &without));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_features(slam, features[0], 30, &count[0]));
  use_buffer();
  for (int k = 0; k < 20; ++k) {
    push_samples(STEP_NS * k + 1, IMU_NS, 6);
    TEST_ASSERT_TRUE(push(slam, k) >= PF_OK);
  }
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &with));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_features(slam, features[1], 30, &count[1]));
  TEST_ASSERT_EQUAL_MEMORY(&without, &with, sizeof with);
  TEST_ASSERT_EQUAL_size_t(count[0], count[1]);
  TEST_ASSERT_EQUAL_MEMORY(features[0], features[1], count[0] * sizeof(pf_feature_t));
}

/* A context that moves by its samples. */
static void use_inertial_model(void) {
  use_inertial_unit(&config, 400);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
  free_block(block);
  block = new_block(need.bytes, 0x55);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, need.bytes, &slam));
}

/* Frames of a camera that stands still, with samples of `still` up to each. */
static void stand_still(int frames) {
  pf_observation_t seen[POINTS];
  int64_t sample_ns = 0;
  for (int k = 0; k < frames; ++k) {
    for (; sample_ns <= STEP_NS * k; sample_ns += IMU_NS) push_samples(sample_ns, 1, 1);
    TEST_ASSERT_TRUE(pf_push_observations(slam, STEP_NS * k, seen, observe(0, seen)) >= PF_OK);
  }
}

static void test_a_second_at_rest_should_tell_gravity_and_the_gyro_s_bias(void) {
  pf_inertial_t inertial;
  double up = 0, force = 0;
  memset(&inertial, 0x55, sizeof inertial);
  use_inertial_model();
  REFUSES(PF_ERROR_STATE, pf_push_control(slam, still.accel, still.gyro));
  TEST_ASSERT_EQUAL_INT(PF_NOTE_NOTHING, pf_get_inertial(slam, &inertial));
  TEST_ASSERT_EQUAL_UINT32(0x55555555, inertial.metric);
  TEST_ASSERT_EQUAL_INT32(0, report_of().used);
  stand_still(20);
  TEST_ASSERT_EQUAL_INT32(1, report_of().used);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_inertial(slam, &inertial));
  TEST_ASSERT_EQUAL_UINT32(0, inertial.metric);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(slam));
  stand_still(40);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_inertial(slam, &inertial));
  TEST_ASSERT_EQUAL_UINT32(1, inertial.metric);
  TEST_ASSERT_EQUAL_UINT32(1, inertial.map_id);
  for (int i = 0; i < 3; ++i) {
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, still.gyro[i], inertial.gyro_bias[i]);
    TEST_ASSERT_TRUE(inertial.covariance[9 * i] > 0);
    up -= inertial.gravity_W[i] * still.accel[i]; /* W is the first camera, whose axes are the unit's */
    force += still.accel[i] * still.accel[i];
  }
  TEST_ASSERT_DOUBLE_WITHIN(1e-2, 9.81 * sqrt(force), up);
}

static void test_an_uncertain_readout_should_be_a_number_of_the_camera(void) {
  const double known = config.camera.readout_s;
  double covariance[100];
  pf_camera_t camera;
  pf_inertial_t inertial;
  config.camera.readout_s = 0.02;
  config.imu.sigma_readout_s = 0.01;
  use_inertial_model();
  stand_still(40); /* which tells nothing of it */
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_camera(slam, &camera, covariance));
  TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0.02, camera.readout_s);
  TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0.01, sqrt(covariance[99]));
  TEST_ASSERT_EQUAL_DOUBLE(0, covariance[0]);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_inertial(slam, &inertial));
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, camera.readout_s, inertial.readout_s);
  TEST_ASSERT_DOUBLE_WITHIN(1e-9, sqrt(covariance[99]), inertial.sigma.readout_s);
  config.camera.readout_s = known;
  config.imu.sigma_readout_s = 0;
}

static void test_a_readout_that_nobody_knows_should_begin_at_zero_and_never_fall_below(void) {
  const double known = config.camera.readout_s;
  pf_inertial_t inertial;
  config.camera.readout_s = 0;
  config.imu.sigma_readout_s = 0.015;
  use_inertial_model();
  stand_still(40);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_inertial(slam, &inertial));
  TEST_ASSERT_TRUE(inertial.readout_s > 0 && inertial.readout_s < 5e-3);
  TEST_ASSERT_DOUBLE_WITHIN(5e-3, 0.015, inertial.sigma.readout_s);
  config.camera.readout_s = known;
  config.imu.sigma_readout_s = 0;
}

static void test_a_delay_that_is_open_should_wait_for_rotation_and_say_so(void) {
  pf_imu_report_t report;
  config.imu.sigma_delay_s = 0.06;
  use_inertial_model();
  stand_still(10);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_imu_report(slam, &report));
  TEST_ASSERT_EQUAL_INT(PF_IMU_REASON_WAITS_FOR_ROTATION, report.reason);
  TEST_ASSERT_EQUAL_INT(0, report.rejected);
  TEST_ASSERT_TRUE(report.gyro_density > 0 && report.accel_density > 0);
  config.imu.sigma_delay_s = 0;
}

static void test_poses_should_go_on_with_the_samples_when_no_frame_shows_anything(void) {
  pf_pose_t before, after, predicted;
  use_inertial_model();
  stand_still(40);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &before));
  /* a turn of 0.5 rad/s about y for 10 samples, which nothing but the gyro sees */
  for (int i = 1; i <= 10; ++i) {
    pf_imu_sample_t sample = at(39 * STEP_NS + IMU_NS * i);
    sample.gyro[1] += 0.5;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_imu(slam, &sample, 1));
  }
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_predict_pose(slam, 39 * STEP_NS + 10 * IMU_NS, &predicted));
  TEST_ASSERT_EQUAL_INT(PF_NOTE_COASTING, pf_push_observations(slam, 39 * STEP_NS + 10 * IMU_NS, NULL, 0));
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &after));
  TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0.5 * 0.5 * 0.05, after.q_WC[2] - before.q_WC[2]);
  TEST_ASSERT_DOUBLE_WITHIN(1e-12, predicted.q_WC[2], after.q_WC[2]);
  TEST_ASSERT_TRUE(after.covariance[0] > before.covariance[0]);
}

/* Samples and frame k of a camera that speeds up sideways after frame 39. It sees the first of the points, and features that are new. */
static pf_status_t push_moving(int k, int known, int unknown) {
  const double a = 0.5, t = 1e-9 * (double)(STEP_NS * (k - 39)); /* [m/s^2] [s] */
  for (int64_t t_ns = STEP_NS * (k - 1) + IMU_NS; t_ns <= STEP_NS * k; t_ns += IMU_NS) {
    pf_imu_sample_t sample = at(t_ns);
    sample.accel[0] += a;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_imu(slam, &sample, 1));
  }
  pf_observation_t seen[POINTS];
  for (int i = 0; i < known; ++i) {
    const double p_C[3] = {-0.9 + 0.36 * (i % 6) - a * t * t / 2, -0.6 + 0.4 * (i / 6), i % 2 ? 2.0 : 3.0};
    seen[i].id = (uint32_t)i;
    seen[i].sigma_px = 0;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_camera_project(&config.camera, p_C, seen[i].pixel));
  }
  for (int i = 0; i < unknown; ++i) {
    const pf_observation_t o = {100u + (uint32_t)i, {20.0 + 6 * i, 60}, 0};
    seen[known + i] = o;
  }
  return pf_push_observations(slam, STEP_NS * k, seen, (size_t)(known + unknown));
}

static void test_asking_for_the_unit_should_leave_the_block_as_it_was(void) {
  pf_inertial_t inertial;
  pf_report_t report;
  config.first_depth.linearity_index = 1;
  config.plane.enabled = 0;
  config.capacity.max_features = POINTS;
  use_inertial_model();
  stand_still(40);
  for (int k = 40; k < 80; ++k) TEST_ASSERT_TRUE(push_moving(k, POINTS, 0) >= PF_OK);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(slam, &report));
  TEST_ASSERT_GREATER_THAN_INT32(2, report.features_point);
  /* New features take the place of points after the last update, so that what was computed for it is out of date. */
  TEST_ASSERT_TRUE(push_moving(80, POINTS - 8, 8) >= PF_OK);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(slam, &report));
  TEST_ASSERT_EQUAL_INT32(8, report.evicted);
  unsigned char* before = new_block(2 * need.bytes, 0);
  unsigned char* after = before + need.bytes;
  copy_block(before, block, need.bytes);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_inertial(slam, &inertial));
  TEST_ASSERT_EQUAL_UINT32(1, inertial.metric);
  TEST_ASSERT_TRUE(inertial.sigma.log_scale > 0);
  copy_block(after, block, need.bytes);
  TEST_ASSERT_EQUAL_MEMORY(before, after, need.bytes);
  free_block(before);
}

static void test_reset_should_forget_the_samples(void) {
  size_t count = 1;
  use_buffer();
  push_samples(IMU_NS, IMU_NS, 20);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_reset(slam));
  TEST_ASSERT_EQUAL_INT64(0, report_of().samples);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_imu_samples(slam, NULL, 0, &count));
  TEST_ASSERT_EQUAL_size_t(0, count);
  push_samples(1, 1, 1);
}

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_samples_should_be_refused_whole_when_one_of_them_is_not_finite);
  RUN_TEST(test_samples_should_be_refused_when_no_unit_could_have_measured_them);
  RUN_TEST(test_samples_should_be_refused_when_time_stands_still_or_runs_back);
  RUN_TEST(test_the_buffer_should_keep_the_newest_samples_in_order);
  RUN_TEST(test_samples_should_be_counted_when_none_are_kept);
  RUN_TEST(test_the_report_should_tell_rate_and_gaps);
  RUN_TEST(test_jitter_should_be_no_gap);
  RUN_TEST(test_saturation_should_be_counted_when_the_ranges_are_known);
  RUN_TEST(test_samples_should_be_counted_between_frames);
  RUN_TEST(test_extreme_times_should_neither_overflow_nor_stop_what_follows);
  RUN_TEST(test_poses_should_be_the_same_with_and_without_samples);
  RUN_TEST(test_a_second_at_rest_should_tell_gravity_and_the_gyro_s_bias);
  RUN_TEST(test_an_uncertain_readout_should_be_a_number_of_the_camera);
  RUN_TEST(test_a_readout_that_nobody_knows_should_begin_at_zero_and_never_fall_below);
  RUN_TEST(test_a_delay_that_is_open_should_wait_for_rotation_and_say_so);
  RUN_TEST(test_poses_should_go_on_with_the_samples_when_no_frame_shows_anything);
  RUN_TEST(test_asking_for_the_unit_should_leave_the_block_as_it_was);
  RUN_TEST(test_reset_should_forget_the_samples);
  return UNITY_END();
}
