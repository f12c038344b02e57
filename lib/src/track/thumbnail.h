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

/// Zero-mean normalised correlation of a(x, y) with b(x - dx, y - dy) over what both show, -1 .. 1; 0 where one of them is flat.
/// |dx|, |dy| less than half of the thumbnail.
float correlate(const Thumbnail& a, const Thumbnail& b, int dx, int dy);

}  // namespace pf
