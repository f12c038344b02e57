/* A small context, the same run of observations for everyone, and all that can be asked, bit for bit. */
#ifndef PLANEFOLD_TESTS_SMALL_CONTEXT_H
#define PLANEFOLD_TESTS_SMALL_CONTEXT_H

#include <planefold/planefold.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#define WIDTH 160
#define HEIGHT 120
#define POINTS 24
#define STEP_NS INT64_C(33000000)

static pf_config_t config;
static pf_memory_t need;
static unsigned char* block;
static pf_slam_t* slam;
static uint8_t pixels[WIDTH * HEIGHT];

/* A block of its own that begins at a multiple of 64 bytes and holds `fill`; free_block gives it back. */
static inline unsigned char* new_block(size_t bytes, int fill) {
  unsigned char* raw = (unsigned char*)malloc(bytes + 64);
  TEST_ASSERT_NOT_NULL(raw);
  memset(raw, fill, bytes + 64);
  const size_t skip = 64 - (size_t)((uintptr_t)raw % 64);
  raw[skip - 1] = (unsigned char)skip;
  return raw + skip;
}

static inline void free_block(unsigned char* at) { free(at - at[-1]); }

/* memcpy that may read the poisoned zones between the pieces of a block. */
#if defined(__GNUC__)
__attribute__((no_sanitize_address))
#endif
static inline void
copy_block(unsigned char* to, const unsigned char* from, size_t bytes) {
  const volatile unsigned char* at = from;
  for (size_t i = 0; i < bytes; ++i) to[i] = at[i];
}

void setUp(void) {
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config));
  const pf_camera_t camera = {PF_CAMERA_PINHOLE,  WIDTH, HEIGHT, 130, 130, 79.5, 59.5, {0}, 0, PF_CAMERA_EXACT,
                              PF_TIMESTAMPS_REAL, 0,     0,      0,   {0}};
  config.camera = camera;
  config.capacity.max_state_dim = 120;
  config.capacity.max_features = 30;
  config.capacity.max_observations = 30;
  config.map.features_in_view = 20;
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
  block = new_block(need.bytes, 0);
  TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block, need.bytes, &slam));
  for (int i = 0; i < WIDTH * HEIGHT; ++i) pixels[i] = (uint8_t)(((uint32_t)i * 2654435761u) >> 24);
}

void tearDown(void) { free_block(block); }

/* What a camera at x = 0.02 k sees of a grid of points on two walls. */
static inline size_t observe(int k, pf_observation_t* out) {
  for (int i = 0; i < POINTS; ++i) {
    const double z = i % 2 ? 2.0 : 3.0, x = -0.9 + 0.36 * (i % 6), y = -0.6 + 0.4 * (i / 6);
    const double p_C[3] = {x - 0.02 * k, y, z};
    out[i].id = (uint32_t)i;
    out[i].sigma_px = 0;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_camera_project(&config.camera, p_C, out[i].pixel));
  }
  return POINTS;
}

static inline pf_status_t push(pf_slam_t* to, int k) {
  pf_observation_t observations[POINTS];
  const size_t count = observe(k, observations);
  return pf_push_observations(to, STEP_NS * (k + 1), observations, count);
}

static inline void run(pf_slam_t* to, int frames) {
  for (int k = 0; k < frames; ++k) TEST_ASSERT_TRUE(push(to, k) >= PF_OK);
}

/* All that can be asked, for comparison bit for bit. */
typedef struct view {
  pf_pose_t pose, later;
  pf_report_t report;
  pf_state_t state;
  pf_feature_t features[30];
  pf_match_t tracks[60];
  size_t feature_count, track_count, imu_count;
  pf_imu_report_t imu;
  pf_imu_sample_t imu_samples[16];
  pf_status_t status[8];
} view_t;

static inline view_t* view_of(const pf_slam_t* of) {
  view_t* v = (view_t*)calloc(1, sizeof *v);
  TEST_ASSERT_NOT_NULL(v);
  v->status[0] = pf_get_pose(of, &v->pose);
  v->status[1] = pf_get_report(of, &v->report);
  v->status[2] = pf_get_state(of, &v->state);
  v->status[3] = pf_get_features(of, v->features, 30, &v->feature_count);
  v->status[4] = pf_get_matches(of, v->tracks, 60, &v->track_count);
  v->status[5] = pf_predict_pose(of, STEP_NS * 1000 / 10, &v->later);
  v->status[6] = pf_get_imu_report(of, &v->imu);
  v->status[7] = pf_get_imu_samples(of, v->imu_samples, 16, &v->imu_count);
  return v;
}

static inline void require_same(view_t* a, view_t* b) {
  TEST_ASSERT_EQUAL_MEMORY(&a->pose, &b->pose, sizeof a->pose);
  TEST_ASSERT_EQUAL_MEMORY(a, b, sizeof *a);
  free(a);
  free(b);
}

/* A refusal: this status, and everything is as it was. */
#define REFUSES(status, call)                           \
  do {                                                  \
    view_t* before_ = view_of(slam);                    \
    TEST_ASSERT_EQUAL_INT_MESSAGE(status, call, #call); \
    require_same(before_, view_of(slam));               \
  } while (0)

#endif
