#pragma once

#include <cstddef>
#include <cstdint>

#include "vision/search.h"

namespace pf {

/// Σ i t of `count` neighbouring windows whose top left pixels begin at `first`.
void window_dots(const std::uint8_t* first, std::ptrdiff_t stride, int count, const SearchTemplate& pattern,
                 std::uint32_t* dot);

/// The plain twin.
void window_dots_reference(const std::uint8_t* first, std::ptrdiff_t stride, int count, const SearchTemplate& pattern,
                           std::uint32_t* dot);

/// Σ i and Σ i² of all windows of a row, from sums over columns 8 pixels high that move down row by row.
class ColumnSums {
 public:
  static constexpr int kMaxColumns = 2 * kSearchReach + SearchTemplate::kSize + 8;

  /// `count` columns whose top pixels begin at `first`. The image is readable there and in the rows to come.
  void begin(const std::uint8_t* first, std::ptrdiff_t stride, int count);

  /// One row further down.
  void move_down();

  /// Of `count` windows from the one that begins in column k, and of up to 7 more, for which there is room in both
  /// arrays; columns beyond the last one count as anything.
  void windows(int k, int count, std::uint16_t* sum, std::uint32_t* square) const;

 private:
  void add(const std::uint8_t* in, const std::uint8_t* out);

  // Room for the vectors that reach beyond the last column.
  static constexpr int kRoom = kMaxColumns + SearchTemplate::kSize + 8;

  const std::uint8_t* first_ = nullptr;
  std::ptrdiff_t stride_ = 0;
  int count_ = 0;
  alignas(16) std::uint16_t sum_[kRoom];
  alignas(16) std::uint32_t square_[kRoom];
};

}  // namespace pf
