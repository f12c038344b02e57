#pragma once

#include "base/arena.h"
#include "base/eigen.h"
#include "vision/image.h"
#include "vision/image_mask.h"

namespace pf {

/// Half-size copies of an image. Level 0 is the caller's own image and is valid as long as that is; level l >= 1 is made
/// of means of 2x2 pixels of level l - 1 (rounded; an odd last row or column is left out).
///
///   x_l = (x_0 + 1/2) / 2^l - 1/2
///
/// Cost of build: about one pass over the image.
struct Pyramid {
  static constexpr int kMaxLevels = 5;
  static constexpr int kSmallestSide = 8;

  int levels = 0;
  ImageView level[kMaxLevels];
  const ImageMask* mask = nullptr;  ///< of level 0, what is not the scene; null: all is

  /// Takes about width * height / 3 bytes. No level is made with a side below kSmallestSide, so `levels` may end up smaller than
  /// wanted_levels. False: a side or the count of levels is not positive.
  bool layout(Arena& arena, int width, int height, int wanted_levels);

  /// Fills all levels from an image of the size that layout was given.
  void build(const ImageView& image);

 private:
  std::uint8_t* buffer_[kMaxLevels] = {};
};

/// Means of 2x2 pixels into rows of `to_stride` bytes: (a + b + c + d + 2) / 4. The reference is the plain twin.
void halve(const ImageView& from, std::uint8_t* to, int to_stride);
void halve_reference(const ImageView& from, std::uint8_t* to, int to_stride);

inline Scalar to_level(Scalar x0, int level) {
  return (x0 + Scalar(0.5)) / static_cast<Scalar>(1 << level) - Scalar(0.5);
}
inline Scalar from_level(Scalar x, int level) {
  return (x + Scalar(0.5)) * static_cast<Scalar>(1 << level) - Scalar(0.5);
}
inline Vec2 to_level(const Vec2& x0, int level) { return Vec2(to_level(x0.x(), level), to_level(x0.y(), level)); }
inline Vec2 from_level(const Vec2& x, int level) { return Vec2(from_level(x.x(), level), from_level(x.y(), level)); }

}  // namespace pf
