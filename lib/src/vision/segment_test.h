#pragma once

#include <cstddef>
#include <cstdint>

namespace pf {

/// Columns of a row that pass the segment test of detect_corners, rising, into `list` (room for `count` entries).
/// All pixels within 3 of the row's piece are readable. Returns how many.
int segment_test_row(const std::uint8_t* centre, std::ptrdiff_t stride, int count, int threshold, std::uint16_t* list);

/// The plain twin.
int segment_test_row_reference(const std::uint8_t* centre, std::ptrdiff_t stride, int count, int threshold,
                               std::uint16_t* list);

}  // namespace pf
