#pragma once

// The library on rendered frames: a scene, a context with its block, and what it said in each frame.

#include <planefold_platform/sim.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "planefold/planefold.h"
#include "unity.h"

namespace pf {

/// A film of a scene, rendered once for all runs of a program that play it: a frame does not depend on how many follow it.
class Film {
 public:
  struct Frame {
    std::vector<std::uint8_t> pixels;
    pf_image_t image;  ///< of these pixels
    pf_pose_t truth;
  };

  static Film& of(const std::string& scene, const pf_sim_options_t& options) {
    static std::map<std::string, std::unique_ptr<Film>> films;
    pf_sim_options_t key = options;
    key.frames = 0;
    std::unique_ptr<Film>& film =
        films[scene + std::string(static_cast<const char*>(static_cast<const void*>(&key)), sizeof(key))];
    if (!film) film = std::make_unique<Film>(scene, options);
    return *film;
  }

  Film(const std::string& scene, pf_sim_options_t options) {
    options.frames = 1000000;
    sim_ = pf_sim_open(scene.c_str(), &options);
    TEST_ASSERT_NOT_NULL(sim_);
  }
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;
  ~Film() { pf_sim_close(sim_); }

  const pf_sim_t* scene() const { return sim_; }

  const Frame& at(std::size_t i) {
    while (frames_.size() <= i) {
      Frame frame = {};
      TEST_ASSERT_EQUAL_INT(1, pf_sim_next(sim_, &frame.image, &frame.truth));
      frame.pixels.assign(frame.image.pixels, frame.image.pixels + frame.image.stride * frame.image.height);
      frames_.push_back(std::move(frame));
      frames_.back().image.pixels = frames_.back().pixels.data();
    }
    return frames_[i];
  }

 private:
  pf_sim_t* sim_;
  std::deque<Frame> frames_;
};

class RenderedRun {
 public:
  static constexpr std::uint64_t kSeed = 3;

  struct Frame {
    pf_status_t status;
    pf_state_t state;
    pf_pose_t pose;  ///< t_ns is -1 where there is none
    pf_report_t report;
    pf_pose_t truth;
    double error_m;  ///< distance from the truth (in W, where there is a target)
  };

  enum class Start { kRectangle, kNone };

  /// Of the runs that are made from now on.
  static inline pf_backend_t backend = PF_BACKEND_FILTER;

  /// change: of what the scene's own options are.
  RenderedRun(const char* scene, int length, Start start, void (*change)(pf_sim_options_t*) = nullptr) {
    std::printf("scene %s, seed %llu\n", scene, static_cast<unsigned long long>(kSeed));
    pf_sim_options_t options;
    std::memset(&options, 0, sizeof(options));
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_options_default(scene, &options));
    options.seed = kSeed;
    options.frames = length;
    if (change != nullptr) change(&options);
    length_ = static_cast<std::size_t>(length);
    film_ = &Film::of(scene, options);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_config_default(&config));
    pf_sim_camera(film_->scene(), &config.camera);
    config.backend = backend;
    if (backend == PF_BACKEND_WINDOW) config.map.features_in_view = 150;
    create();
    if (start == Start::kRectangle) start_at_rectangle();
  }
  RenderedRun(const RenderedRun&) = delete;
  RenderedRun& operator=(const RenderedRun&) = delete;
  ~RenderedRun() { std::free(block_); }

  /// A context as config says, in a block of its own.
  void create() {
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_memory_query(&config, &need));
    std::free(block_);
    block_ = std::aligned_alloc(need.alignment, (need.bytes + need.alignment) / need.alignment * need.alignment);
    TEST_ASSERT_NOT_NULL(block_);
    std::memset(block_, 0x7f, need.bytes);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_create(&config, block_, need.bytes, &slam));
  }

  void start_at_rectangle() {
    pf_target_t target;
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_sim_target(film_->scene(), PF_TARGET_RECTANGLE, &target));
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_start_from_target(slam, &target));
  }

  const pf_sim_t* scene() const { return film_->scene(); }

  /// The first frames of the film are not shown.
  void skip(int count) {
    pf_image_t image;
    for (int i = 0; i < count; ++i) TEST_ASSERT_TRUE(next_image(&image));
  }

  bool next_image(pf_image_t* image) {
    if (shown_ == length_) return false;
    const Film::Frame& frame = film_->at(shown_++);
    *image = frame.image;
    truth_ = frame.truth;
    return true;
  }

  /// The next frame goes in, under `cover` if that is not negative: then all its pixels have that grey level.
  bool step(int cover = -1) {
    pf_image_t image;
    if (!next_image(&image)) return false;
    seen_.assign(image.pixels, image.pixels + image.stride * image.height);
    if (contrast < 1) {
      for (std::uint8_t& grey : seen_) grey = static_cast<std::uint8_t>(std::lround(110 + contrast * (grey - 110)));
      image.pixels = seen_.data();
    }
    if (zoom > 1) {
      zoom_of(image);
      image.pixels = seen_.data();
    }
    if (smear > 1) {
      smeared_ = seen_;
      for (int v = 0; v < image.height; ++v)
        for (int u = 0; u < image.width; ++u) {
          int sum = 0;
          for (int k = 0; k < smear; ++k)
            sum +=
                seen_[static_cast<std::size_t>(v * image.stride + std::clamp(u + k - smear / 2, 0, image.width - 1))];
          smeared_[static_cast<std::size_t>(v * image.stride + u)] =
              static_cast<std::uint8_t>((sum + smear / 2) / smear);
        }
      image.pixels = smeared_.data();
    }
    if (flicker > 0) {
      flicker_of(image);
      image.pixels = smeared_.data();
    }
    if (cover >= 0) {
      covered_.assign(static_cast<std::size_t>(image.stride * image.height), static_cast<std::uint8_t>(cover));
      image.pixels = covered_.data();
    }
    push(image);
    return true;
  }

  /// The time of the next frame with the picture of the last one: a driver that repeats, or a frozen camera.
  bool freeze() {
    pf_image_t image;
    if (!next_image(&image)) return false;
    image.pixels = seen_.data();
    push(image);
    return true;
  }

  /// Steps until `count` frames are done; how many of those were tracked.
  int tracked_until(std::size_t count, int cover = -1) {
    int tracked = 0;
    while (frames.size() < count && step(cover)) tracked += frames.back().status == PF_OK ? 1 : 0;
    TEST_ASSERT_EQUAL_size_t(count, frames.size());
    return tracked;
  }

  double worst_error(std::size_t first) const {
    double worst = 0;
    for (std::size_t i = first; i < frames.size(); ++i)
      if (frames[i].status == PF_OK && frames[i].error_m > worst) worst = frames[i].error_m;
    return worst;
  }

  double contrast = 1;  ///< of what is left of it
  double flicker = 0;   ///< share of the picture, from its right side, whose texture is another one in every frame
  double zoom = 1;      ///< times as long as the scene's lens
  int smear = 1;        ///< [px] along the rows, of a camera that turns while it exposes
  pf_config_t config;
  pf_memory_t need;
  pf_slam_t* slam = nullptr;
  std::vector<Frame> frames;

 private:
  static constexpr int kFlickerSide = 3;  ///< [px] of a patch of one grey level

  void flicker_of(const pf_image_t& image) {
    std::vector<std::uint8_t> out(image.pixels, image.pixels + image.stride * image.height);
    std::minstd_rand random(static_cast<unsigned>(shown_));
    for (int v = 0; v + kFlickerSide <= image.height; v += kFlickerSide)
      for (int u = static_cast<int>((1 - flicker) * image.width); u + kFlickerSide <= image.width; u += kFlickerSide) {
        const std::uint8_t grey = static_cast<std::uint8_t>(60 + random() % 130);
        for (int i = 0; i < kFlickerSide * kFlickerSide; ++i)
          out[static_cast<std::size_t>((v + i / kFlickerSide) * image.stride + u + i % kFlickerSide)] = grey;
      }
    smeared_ = std::move(out);
  }

  /// Bilinear, about the middle.
  void zoom_of(const pf_image_t& image) {
    const std::vector<std::uint8_t> from = seen_;
    const auto grey = [&](int u, int v) { return 1.0 * from[static_cast<std::size_t>(v * image.stride + u)]; };
    const double cx = config.camera.cx, cy = config.camera.cy;
    for (int v = 0; v < image.height; ++v)
      for (int u = 0; u < image.width; ++u) {
        const double x = std::clamp(cx + (u - cx) / zoom, 0.0, image.width - 1.001);
        const double y = std::clamp(cy + (v - cy) / zoom, 0.0, image.height - 1.001);
        const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
        const double a = x - x0, b = y - y0;
        seen_[static_cast<std::size_t>(v * image.stride + u)] =
            static_cast<std::uint8_t>(std::lround((1 - b) * ((1 - a) * grey(x0, y0) + a * grey(x0 + 1, y0)) +
                                                  b * ((1 - a) * grey(x0, y0 + 1) + a * grey(x0 + 1, y0 + 1))));
      }
  }

  void push(const pf_image_t& image) {
    Frame f = {};
    f.status = pf_push_frame(slam, &image);
    TEST_ASSERT_TRUE(f.status >= PF_OK);
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_state(slam, &f.state));
    TEST_ASSERT_EQUAL_INT(PF_OK, pf_get_report(slam, &f.report));
    if (pf_get_pose(slam, &f.pose) != PF_OK) f.pose.t_ns = -1;
    f.truth = truth_;
    double sum = 0;
    for (int i = 0; i < 3; ++i) sum += (f.pose.p_WC[i] - truth_.p_WC[i]) * (f.pose.p_WC[i] - truth_.p_WC[i]);
    f.error_m = std::sqrt(sum);
    frames.push_back(f);
  }

  Film* film_ = nullptr;
  std::size_t length_ = 0, shown_ = 0;  ///< frames
  void* block_ = nullptr;
  pf_pose_t truth_ = {};
  std::vector<std::uint8_t> covered_, seen_, smeared_;
};

}  // namespace pf
