#pragma once

#include <cstddef>
#include <cstdint>

namespace pf {

/// A view of grey levels that somebody else owns. Pixel (0, 0) is the centre of the top-left one.
///
/// stride   bytes from row to row, >= width
struct ImageView {
  const std::uint8_t* data = nullptr;
  int width = 0;
  int height = 0;
  int stride = 0;

  const std::uint8_t* row(int y) const {
    return data + static_cast<std::ptrdiff_t>(y) * static_cast<std::ptrdiff_t>(stride);
  }
  const std::uint8_t* pixel(int x, int y) const { return row(y) + x; }
  int at(int x, int y) const { return row(y)[x]; }

  /// The pixel and `margin` more on each side lie inside.
  bool contains(int x, int y, int margin = 0) const {
    return x >= margin && y >= margin && x < width - margin && y < height - margin;
  }
};

/// Half-open: columns x .. x + width - 1, rows y .. y + height - 1. Empty when a side is not positive.
struct Rect {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  bool empty() const { return width <= 0 || height <= 0; }
};

/// The part of a rectangle that lies at least `margin` inside the image. Takes any rectangle.
inline Rect clip(const Rect& rect, const ImageView& image, int margin) {
  const auto low = [margin](int begin) { return begin > margin ? begin : margin; };
  const auto high = [margin](int begin, int length, int limit) {
    const std::int64_t end = static_cast<std::int64_t>(begin) + length;
    return end < limit - margin ? static_cast<int>(end > 0 ? end : 0) : limit - margin;
  };
  Rect out;
  out.x = low(rect.x);
  out.y = low(rect.y);
  out.width = rect.empty() ? 0 : high(rect.x, rect.width, image.width) - out.x;
  out.height = rect.empty() ? 0 : high(rect.y, rect.height, image.height) - out.y;
  return out;
}

}  // namespace pf
