#pragma once

// A camera before one textured wall, rendered, with patches of the walls that a test says are there.

#include <planefold/planefold.h>
#include <planefold_platform/sim.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include "unity.h"

class WallWalk {
 public:
  /// features: in view; negative: the default. With the window there are no patches.
  WallWalk(int frames, int patches, int features, pf_backend_t backend = PF_BACKEND_FILTER)
      : sim_(open(frames), pf_sim_close) {
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config_));
    pf_sim_camera(sim_.get(), &config_.camera);
    config_.capacity.max_patches = patches;
    config_.backend = backend;
    config_.capacity.patch_side_px = 64;
    if (features >= 0) config_.map.features_in_view = features;
    pf_memory_t need;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config_, &need));
    block_.reset(std::aligned_alloc(need.alignment, (need.bytes + need.alignment) / need.alignment * need.alignment));
    std::memset(block_.get(), 0x7f, need.bytes);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config_, block_.get(), need.bytes, &slam));
    start();
  }

  /// From the first frame on, at its true pose.
  void start() {
    pf_sim_rewind(sim_.get());
    pf_pose_t first;
    pf_sim_pose_at(sim_.get(), 0, &first);
    double velocities[36] = {};
    for (int i = 0; i < 6; ++i) {
      first.covariance[7 * i] = 1e-6;
      velocities[7 * i] = 1e-2;
    }
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_pose(slam, &first, velocities));
  }

  /// A wall at W's origin, turned about the vertical; z towards the camera, which looks along z of W. Its covariance is the caller's.
  static pf_wall_prior_t wall(double turn_rad, double half_width) {
    pf_wall_prior_t prior = {};
    const double c = std::cos(turn_rad), s = std::sin(turn_rad);
    const double R[9] = {-c, 0, s, 0, 1, 0, -s, 0, -c};
    const double corner[4][2] = {{-half_width, -1.8}, {half_width, -1.8}, {half_width, 1.8}, {-half_width, 1.8}};
    std::memcpy(prior.R_WP, R, sizeof R);
    prior.outline_count = 4;
    std::memcpy(prior.outline_P, corner, sizeof corner);
    return prior;
  }

  std::uint32_t add(const pf_wall_prior_t& prior) {
    std::uint32_t id;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_add_wall(slam, &prior, &id));
    return id;
  }

  /// The next frame, or darkness in its place. gross: what surrounds this patch is moved in the image.
  pf_status_t step(bool dark = false, const pf_patch_t* gross = nullptr) {
    pf_image_t image;
    pf_pose_t truth;
    TEST_ASSERT_EQUAL_INT(1, pf_sim_next(sim_.get(), &image, &truth));
    const std::vector<std::uint8_t> black(static_cast<std::size_t>(image.stride * image.height));
    std::vector<std::uint8_t> pixels(image.pixels, image.pixels + black.size());
    if (gross != nullptr) move(*gross, image, &pixels);
    image.pixels = dark ? black.data() : pixels.data();
    const pf_status_t status = pf_push_frame(slam, &image);
    TEST_ASSERT_TRUE(status >= PF_OK);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_pose(slam, &pose));
    double square = 0;
    for (int i = 0; i < 3; ++i) square += std::pow(pose.p_WC[i] - truth.p_WC[i], 2);
    error_m = std::sqrt(square);
    return status;
  }

  std::vector<pf_patch_t> patches() const {
    constexpr std::size_t kMost = 32;  // that a config may have
    std::vector<pf_patch_t> all(kMost);
    std::size_t count;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_patches(slam, all.data(), all.size(), &count));
    all.resize(count);
    return all;
  }

  const pf_config_t& config() const { return config_; }

  pf_slam_t* slam = nullptr;
  pf_pose_t pose;
  double error_m = 0;  ///< of the last frame's position

 private:
  static pf_sim_t* open(int frames) {
    pf_sim_options_t options;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_options_default("wall", &options));
    options.seed = 5;
    options.frames = frames;
    options.samples = 1;
    pf_sim_t* sim = pf_sim_open("wall", &options);
    TEST_ASSERT_NOT_NULL(sim);
    return sim;
  }

  /// By less than the aligner reaches, and far more than noise.
  static void move(const pf_patch_t& patch, const pf_image_t& image, std::vector<std::uint8_t>* pixels) {
    constexpr int kDown = 6, kRight = 5, kMargin = 10;  // [px]
    double low[2] = {patch.corners_px[0][0], patch.corners_px[0][1]}, high[2] = {low[0], low[1]};
    for (const double* corner : patch.corners_px)
      for (int a = 0; a < 2; ++a) {
        low[a] = std::fmin(low[a], corner[a] - kMargin);
        high[a] = std::fmax(high[a], corner[a] + kMargin);
      }
    for (int y = static_cast<int>(low[1]); y <= high[1]; ++y)
      for (int x = static_cast<int>(low[0]); x <= high[0]; ++x) {
        if (x < kRight || y < kDown || x >= image.width || y >= image.height) continue;
        (*pixels)[static_cast<std::size_t>(y * image.stride + x)] =
            image.pixels[(y - kDown) * image.stride + x - kRight];
      }
  }

  std::unique_ptr<pf_sim_t, void (*)(pf_sim_t*)> sim_;
  pf_config_t config_;
  std::unique_ptr<void, void (*)(void*)> block_{nullptr, std::free};
};
