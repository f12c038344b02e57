#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace pf {

/// Nanoseconds from one timestamp to another that is not before it; the largest value that fits where the clock has
/// jumped further.
inline std::int64_t elapsed_ns(std::int64_t from, std::int64_t to) {
  const std::uint64_t gap = static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from);
  return gap > static_cast<std::uint64_t>(INT64_MAX) ? INT64_MAX : static_cast<std::int64_t>(gap);
}

inline double seconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }
/// Cut off at 292 years either way.
inline std::int64_t nanoseconds(double s) {
  constexpr double kMost = 9.2e18;
  return static_cast<std::int64_t>(std::clamp(s * 1e9, -kMost, kMost));
}

/// A frame counter that stops before it would overflow (after about seven months at 60 Hz; smaller types at their largest value).
template <class Int>
inline void count_frame(Int* count) {
  if (*count < std::min<std::intmax_t>(1000000000, std::numeric_limits<Int>::max())) ++*count;
}

}  // namespace pf
