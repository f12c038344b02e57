// What a block held before a context was made in it shows in nothing that is saved: each kind of context, before its first frame and later.
#include <planefold/planefold.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "support/continued.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr std::int64_t kStepNs = 33333333;

struct Kind {
  const char* name;
  pf_backend_t backend;
  bool observes;
  void (*change)(pf_config_t*);
  bool has_wall;
};

void with_unit(pf_config_t* config) {
  config->motion.model = PF_MOTION_INERTIAL;
  config->capacity.max_imu_samples = 64;
  config->imu.gyro_density = 1e-3;
  config->imu.accel_density = 1e-2;
  config->imu.gyro_walk = config->imu.accel_walk = 1e-4;
}

void with_open_unit(pf_config_t* config) {
  with_unit(config);
  config->imu.sigma_mount_rad = 0.05;
  config->imu.sigma_mount_m = config->imu.sigma_delay_s = config->imu.sigma_scale = 0.01;
}

void with_open_lens(pf_config_t* config) {
  config->camera.estimate = PF_CAMERA_ESTIMATE;
  config->camera.sigma_focal = 0.02;
  config->camera.sigma_aspect = 0.001;
  config->camera.sigma_centre_px = 2;
}

void with_masks(pf_config_t* config) { config->map.masks = PF_MASKS_PARTIAL; }

void with_patches(pf_config_t* config) {
  config->capacity.max_patches = 4;
  config->capacity.patch_side_px = 48;
}

void plain(pf_config_t*) {}

const Kind kKinds[] = {
    {"filter", PF_BACKEND_FILTER, false, plain, false},
    {"window", PF_BACKEND_WINDOW, false, plain, false},
    {"filter, pixels", PF_BACKEND_FILTER, true, plain, true},
    {"window, pixels", PF_BACKEND_WINDOW, true, plain, true},
    {"filter, unit", PF_BACKEND_FILTER, false, with_unit, false},
    {"window, unit", PF_BACKEND_WINDOW, true, with_unit, false},
    {"filter, open unit", PF_BACKEND_FILTER, true, with_open_unit, false},
    {"window, open unit", PF_BACKEND_WINDOW, false, with_open_unit, false},
    {"filter, open lens", PF_BACKEND_FILTER, false, with_open_lens, false},
    {"window, open lens", PF_BACKEND_WINDOW, false, with_open_lens, false},
    {"filter, masks", PF_BACKEND_FILTER, false, with_masks, false},
    {"window, masks", PF_BACKEND_WINDOW, false, with_masks, false},
    {"filter, patches", PF_BACKEND_FILTER, false, with_patches, true},
    {"window, wall", PF_BACKEND_WINDOW, false, plain, true},
};

class Context {
 public:
  Context(const Kind& kind, unsigned char fill) : kind_(kind) {
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config_));
    config_.camera = {PF_CAMERA_PINHOLE,  kWidth, kHeight, 130, 130, 79.5, 59.5, {}, 0, PF_CAMERA_EXACT,
                      PF_TIMESTAMPS_REAL, 0,      0,       0,   {}};
    config_.backend = kind.backend;
    config_.capacity.max_places = 4;
    kind.change(&config_);
    const char* field = nullptr;
    if (pf_config_check(&config_, &field) != PF_OK) TEST_FAIL_MESSAGE(field);
    pf_memory_t need;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config_, &need));
    block_ = std::aligned_alloc(need.alignment, (need.bytes / need.alignment + 1) * need.alignment);
    TEST_ASSERT_NOT_NULL(block_);
    std::memset(block_, fill, need.bytes);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config_, block_, need.bytes, &slam));
    if (kind.has_wall) start_before_a_wall();
  }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  ~Context() { std::free(block_); }

  void push(int k) {
    for (int s = 0; s < 4 && config_.motion.model == PF_MOTION_INERTIAL; ++s) {
      const pf_imu_sample_t sample = {k * kStepNs + s * kStepNs / 4 + 1, {0.001 * s, 0, 0}, {0, -9.81, 0.01}};
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_push_imu(slam, &sample, 1));
    }
    const pf_status_t status = kind_.observes ? push_pixels(k) : push_image(k);
    TEST_ASSERT_TRUE(status >= PF_OK);
  }

  pf_slam_t* slam = nullptr;

 private:
  void start_before_a_wall() {
    pf_pose_t pose{};
    double velocity[36] = {};
    pose.q_WC[0] = 1;
    for (int i = 0; i < 6; ++i) pose.covariance[7 * i] = 1e-4, velocity[7 * i] = 1e-2;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_pose(slam, &pose, velocity));
    pf_wall_prior_t wall{};
    wall.R_WP[0] = 1;
    wall.R_WP[4] = wall.R_WP[8] = -1;
    wall.p_WP[2] = 3;
    for (int i = 0; i < 3; ++i) wall.covariance[4 * i] = 1e-4;
    const double corner[4][2] = {{-3, -3}, {3, -3}, {3, 3}, {-3, 3}};
    wall.outline_count = 4;
    std::memcpy(wall.outline_P, corner, sizeof corner);
    std::uint32_t id = 0;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_wall(slam, &wall, &id));
  }

  /// Blocks of two depths before a camera that moves sideways.
  pf_status_t push_image(int k) {
    static std::vector<std::uint8_t> grey(kWidth * kHeight);
    const auto hash = [](int x, int y) {
      return (static_cast<std::uint32_t>(x) * 73856093u ^ static_cast<std::uint32_t>(y) * 19349663u) * 2654435761u >>
             24;
    };
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const int far = x + k, near = x + 3 * k;
        const bool is_near = hash(near / 23, 7 + y / 19) % 3 == 0;
        grey[static_cast<std::size_t>(y * kWidth + x)] =
            static_cast<std::uint8_t>(is_near ? hash(near / 6, 100 + y / 5) : hash(far / 7, y / 6));
      }
    const pf_image_t image = {grey.data(), kWidth, kHeight, kWidth, (k + 1) * kStepNs};
    return pf_push_frame(slam, &image);
  }

  /// Points on two walls.
  pf_status_t push_pixels(int k) {
    std::vector<pf_observation_t> seen;
    for (int i = 0; i < 60; ++i) {
      const double p_C[3] = {-1.5 + 0.3 * (i % 10) - 0.02 * k, -0.9 + 0.3 * (i / 10), i % 2 == 0 ? 2.0 : 3.0};
      pf_observation_t o = {static_cast<std::uint32_t>(i), {}, 0};
      TEST_ASSERT_EQUAL_INT(PF_OK, pf_camera_project(&config_.camera, p_C, o.pixel));
      if (o.pixel[0] > 0 && o.pixel[0] < kWidth - 1 && o.pixel[1] > 0 && o.pixel[1] < kHeight - 1) seen.push_back(o);
    }
    return pf_push_observations(slam, (k + 1) * kStepNs, seen.data(), seen.size());
  }

  const Kind& kind_;
  pf_config_t config_;
  void* block_ = nullptr;
};

void test_old_bytes_of_a_block_should_not_show_in_what_is_saved() {
  for (const Kind& kind : kKinds) {
    std::printf("%s\n", kind.name);
    Context one(kind, 0), other(kind, 0x7f), third(kind, 0xff);
    for (int k = 0; k <= 60; ++k) {
      if (k < 3 || k % 20 == 0) {
        const std::vector<std::uint8_t> saved = pf::saved_to_continue(one.slam);
        TEST_ASSERT_TRUE(saved == pf::saved_to_continue(other.slam));
        TEST_ASSERT_TRUE(saved == pf::saved_to_continue(third.slam));
      }
      for (Context* each : {&one, &other, &third}) each->push(k);
    }
  }
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_old_bytes_of_a_block_should_not_show_in_what_is_saved);
  return UNITY_END();
}
