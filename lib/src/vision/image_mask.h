#pragma once

#include <cstdint>

#include "base/arena.h"
#include "base/eigen.h"
#include "vision/image.h"

namespace pf {

class Archive;

/// Which parts of the image are not the scene (the carrier's own body, a date that is written over the picture), one bit for each cell of
/// 4 x 4 px. A cell of which any pixel is masked is masked.
class ImageMask {
 public:
  static constexpr int kCell = 4;  ///< [px] side of a cell

  /// ceil(width / side) * ceil(height / side) bits. side: of a cell [px].
  bool layout(Arena& arena, int width, int height, int side = kCell);
  /// Nothing is masked.
  void init();

  /// What another mask masks counts as well; null: nothing. init() keeps it.
  void set_also(const ImageMask* also) { also_ = also; }
  /// Masks the cells that a rectangle touches.
  void add(const Rect& rect);

  bool has_masked() const { return masked_ > 0 || (also_ != nullptr && also_->has_masked()); }
  int cells() const { return columns_ * rows_; }
  /// Share of the image that is masked here, without what counts as well [1/1000].
  int share() const { return 1000 * masked_ / cells(); }
  /// The pixels of a cell; its right and lower edge may lie outside of the image.
  Rect cell(int index) const { return {index % columns_ * side_, index / columns_ * side_, side_, side_}; }
  /// Masks the cells for which is_masked(Rect) is true, and no others.
  template <typename F>
  void assign(F&& is_masked);

  /// Whether no pixel of a rectangle is masked. What lies outside of the image is not masked.
  bool is_clear(const Rect& rect) const;
  /// The square of so many pixels to each side of a pixel.
  bool is_clear(const Vec2& pixel, int margin) const;
  /// Whether any cell of a rectangle is clear.
  bool has_clear(const Rect& rect) const;

  void carry(Archive& archive);  ///< base/archive.h

 private:
  struct Span {
    int left, top, right, bottom;  ///< cells, half-open
  };
  Span span_of(const Rect& rect) const;
  bool is_masked(int column, int row) const {
    const int at = row * columns_ + column;
    return (bits_[at / 32] >> (at % 32) & 1u) != 0;
  }

  std::uint32_t* bits_ = nullptr;
  int columns_ = 0, rows_ = 0, side_ = kCell;
  int masked_ = 0;  ///< cells
  const ImageMask* also_ = nullptr;
};

/// The mask where there is one and it masks anything, else null: called once before loops over pixels.
inline const ImageMask* in_use(const ImageMask* mask) { return mask != nullptr && mask->has_masked() ? mask : nullptr; }

template <typename F>
void ImageMask::assign(F&& is_masked_cell) {
  init();
  for (int i = 0; i < cells(); ++i) {
    if (!is_masked_cell(cell(i))) continue;
    bits_[i / 32] |= 1u << (i % 32);
    ++masked_;
  }
}

}  // namespace pf
