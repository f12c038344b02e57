#pragma once

#include "base/eigen.h"
#include "vision/pyramid.h"

namespace pf {

/// A square of an image that shows a part of a plane: what is found again in later frames under a homography. Its pixels with half-size
/// copies, and which of them are compared. A plain copy: no pointers.
struct PlanePatch {
  static constexpr int kMinSide = 13, kMaxSide = 128, kLevels = 3;
  static constexpr int kMaxSamples = 2500;  ///< pixels of a level that are compared
  static constexpr int kPixels = kMaxSide * kMaxSide * 21 / 16;

  std::int16_t left = 0, top = 0;  ///< first pixel in the image that it is from
  std::int16_t side = 0;           ///< [px]
  std::int16_t levels = 0;
  float mean = 0;                                ///< of level 0 [grey]
  std::uint8_t pixels[kPixels] = {};             ///< level behind level, row by row
  std::uint8_t chosen[kMaxSide * kMaxSide / 8];  ///< a bit for each pixel of level 0

  int side_of(int level) const { return side >> level; }
  const std::uint8_t* level(int l) const {
    const std::uint8_t* from = pixels;
    for (int k = 0; k < l; ++k) from += side_of(k) * side_of(k);
    return from;
  }
  bool is_chosen(int x, int y) const { return (chosen[(y * side + x) / 8] >> ((y * side + x) % 8) & 1) != 0; }
  /// Centres of its corner pixels in the image that it is from, in the order of a circle [px].
  Vec2 corner(int k) const {
    const Scalar x = left, y = top, far = static_cast<Scalar>(side - 1);
    return Vec2(k == 1 || k == 2 ? x + far : x, k >= 2 ? y + far : y);
  }
};
static_assert(sizeof(PlanePatch) <= 24 * 1024);

/// Copies a square of an image, makes its levels, and chooses the pixels of level 0 that are compared: those with the largest gradients,
/// since at equal noise they have most information about the place. False, patch undefined: it leaves the image, its side is not in
/// kMinSide .. kMaxSide, or it has too little texture in some direction.
bool extract_plane_patch(const ImageView& image, int left, int top, int side, PlanePatch* patch);

}  // namespace pf
