#include "vision/image_mask.h"

#include <algorithm>
#include <cmath>

namespace pf {

bool ImageMask::layout(Arena& arena, int width, int height, int side) {
  side_ = side;
  columns_ = (width + side - 1) / side;
  rows_ = (height + side - 1) / side;
  bits_ = arena.take<std::uint32_t>(static_cast<std::size_t>(cells() + 31) / 32);
  return arena.ok();
}

void ImageMask::init() {
  std::fill(bits_, bits_ + (cells() + 31) / 32, 0u);
  masked_ = 0;
}

ImageMask::Span ImageMask::span_of(const Rect& rect) const {
  const auto cells_from = [this](int at, int count) { return std::clamp(at, 0, count * side_) / side_; };
  const auto cells_to = [this](int at, int count) { return (std::clamp(at, 0, count * side_) + side_ - 1) / side_; };
  if (rect.empty()) return {0, 0, 0, 0};
  return {cells_from(rect.x, columns_), cells_from(rect.y, rows_), cells_to(rect.x + rect.width, columns_),
          cells_to(rect.y + rect.height, rows_)};
}

void ImageMask::add(const Rect& rect) {
  const Span span = span_of(rect);
  for (int row = span.top; row < span.bottom; ++row)
    for (int column = span.left; column < span.right; ++column) {
      const int at = row * columns_ + column;
      std::uint32_t& bits = bits_[at / 32];
      const std::uint32_t bit = 1u << (at % 32);
      masked_ += (bits & bit) == 0 ? 1 : 0;
      bits |= bit;
    }
}

bool ImageMask::is_clear(const Rect& rect) const {
  const Span span = span_of(rect);
  for (int row = span.top; row < span.bottom; ++row)
    for (int column = span.left; column < span.right; ++column)
      if (is_masked(column, row)) return false;
  return also_ == nullptr || also_->is_clear(rect);
}

bool ImageMask::is_clear(const Vec2& pixel, int margin) const {
  // Far outside of the image the numbers may not fit, and there is nothing masked.
  const Scalar width = static_cast<Scalar>(columns_ * side_ + margin);
  const Scalar height = static_cast<Scalar>(rows_ * side_ + margin);
  const Scalar low = static_cast<Scalar>(-margin - 1);
  if (!(pixel.x() > low && pixel.y() > low && pixel.x() < width && pixel.y() < height)) return true;
  const int x = static_cast<int>(std::floor(pixel.x() + Scalar(0.5)));
  const int y = static_cast<int>(std::floor(pixel.y() + Scalar(0.5)));
  return is_clear(Rect{x - margin, y - margin, 2 * margin + 1, 2 * margin + 1});
}

bool ImageMask::has_clear(const Rect& rect) const {
  const Span span = span_of(rect);
  for (int row = span.top; row < span.bottom; ++row)
    for (int column = span.left; column < span.right; ++column)
      if (!is_masked(column, row) &&
          (also_ == nullptr || also_->is_clear(Rect{column * side_, row * side_, side_, side_})))
        return true;
  return false;
}

}  // namespace pf
