#pragma once

#include <cstdint>

namespace pf {

/// Nanoseconds from one timestamp to another that is not before it; the most that fits where the caller's clock has leapt further.
inline std::int64_t elapsed_ns(std::int64_t from, std::int64_t to) {
  const std::uint64_t gap = static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from);
  return gap > static_cast<std::uint64_t>(INT64_MAX) ? INT64_MAX : static_cast<std::int64_t>(gap);
}

/// A count of frames that stops far below overflow, which 60 frames a second reach in seven months.
template <class Int>
inline void count_frame(Int* count) {
  if (*count < 1000000000) ++*count;
}

}  // namespace pf
