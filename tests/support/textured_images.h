#pragma once

// Images of a smooth random texture, known at every real position, and images with a given wavelength of detail.

#include <cmath>
#include <cstdint>
#include <vector>

#include "base/arena.h"
#include "support/seeded_random.h"
#include "vision/image.h"

namespace pf {

/// A sum of waves: mean 128, about 40 grey levels standard deviation, no wavelength below `shortest` pixels.
class Texture {
 public:
  Texture(SeededRandom* random, double shortest, double longest) {
    for (Wave& wave : waves_) {
      const double direction = random->uniform(0, 6.283185307179586);
      const double k = 6.283185307179586 / random->uniform(shortest, longest);
      wave = Wave{k * std::cos(direction), k * std::sin(direction), random->uniform(0, 6.283185307179586)};
    }
  }

  double at(double x, double y) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::cos(wave.kx * x + wave.ky * y + wave.phase);
    return 128 + sum * 40 * std::sqrt(2.0 / kWaves);
  }

 private:
  static constexpr int kWaves = 24;
  struct Wave {
    double kx, ky, phase;
  };
  Wave waves_[kWaves];
};

/// Owns exactly its pixels, so that a sanitizer sees every reading beyond them.
struct TestImage {
  TestImage(int width, int height) : pixels(static_cast<std::size_t>(width * height)), width_(width), height_(height) {}

  /// grey(x, y) rounded and limited to 0 .. 255.
  template <class Grey>
  TestImage(int width, int height, const Grey& grey) : TestImage(width, height) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) set(x, y, grey(x, y));
    }
  }

  void set(int x, int y, double grey) {
    pixels[static_cast<std::size_t>(y * width_ + x)] = static_cast<std::uint8_t>(grey < 0     ? 0
                                                                                 : grey > 255 ? 255
                                                                                              : std::lround(grey));
  }

  ImageView view() const { return ImageView{pixels.data(), width_, height_, width_}; }

  std::vector<std::uint8_t> pixels;

 private:
  int width_, height_;
};

inline TestImage noise_image(int width, int height, SeededRandom* random) {
  return TestImage(width, height, [&](int, int) { return std::floor(random->uniform(0, 256)); });
}

/// An arena with a block of its own.
class TestArena {
 public:
  explicit TestArena(std::size_t bytes = std::size_t{4} << 20) : block_(bytes + Arena::kAlignment) {
    const std::uintptr_t at = reinterpret_cast<std::uintptr_t>(block_.data());
    const std::size_t skip = (Arena::kAlignment - at % Arena::kAlignment) % Arena::kAlignment;
    arena_ = Arena(block_.data() + skip, bytes);
  }
  TestArena(const TestArena&) = delete;
  TestArena& operator=(const TestArena&) = delete;
  ~TestArena() {
#if defined(PF_HAS_RED_ZONES)
    ASAN_UNPOISON_MEMORY_REGION(block_.data(), block_.size());
#endif
  }

  Arena& operator*() { return arena_; }

 private:
  std::vector<std::uint8_t> block_;
  Arena arena_;
};

}  // namespace pf
