#pragma once

#include <cstdint>

namespace pf {

/// Nanoseconds from one timestamp to another that is not before it; the largest value that fits where the clock has
/// jumped further.
inline std::int64_t elapsed_ns(std::int64_t from, std::int64_t to) {
  const std::uint64_t gap = static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from);
  return gap > static_cast<std::uint64_t>(INT64_MAX) ? INT64_MAX : static_cast<std::int64_t>(gap);
}

inline double seconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }

/// A frame counter that stops well before it would overflow (after about seven months at 60 Hz).
template <class Int>
inline void count_frame(Int* count) {
  if (*count < 1000000000) ++*count;
}

}  // namespace pf
