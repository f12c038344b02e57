#pragma once

#include <cstdint>

#include "vision/pyramid.h"

/// An image made so small that it shows the view and not its details (Klein and Murray 2008).

namespace pf {

struct Thumbnail {
  static constexpr int kWidth = 40, kHeight = 30;
  std::uint8_t pixels[kWidth * kHeight];

  int at(int x, int y) const { return pixels[y * kWidth + x]; }
};

/// Means over the areas that its pixels cover.
void make_thumbnail(const Pyramid& pyramid, Thumbnail* thumbnail);

/// Pixels of a thumbnail that show something masked.
struct ThumbnailMask {
  bool has_masked = false;
  bool masked[Thumbnail::kWidth * Thumbnail::kHeight];

  bool at(int x, int y) const { return masked[y * Thumbnail::kWidth + x]; }
};

/// Of an image's mask, or of none.
void make_thumbnail_mask(const Pyramid& pyramid, ThumbnailMask* mask);

/// Zero-mean normalised correlation of a(x, y) with b(x - dx, y - dy) over what both show, -1 .. 1; 0 where one of them is flat.
/// |dx|, |dy| less than half of the thumbnail.
float correlate(const Thumbnail& a, const Thumbnail& b, int dx, int dy);
/// The same without the pixels that are masked in either; 0 where fewer than a quarter are left.
float correlate(const Thumbnail& a, const Thumbnail& b, int dx, int dy, const ThumbnailMask& mask);

}  // namespace pf
