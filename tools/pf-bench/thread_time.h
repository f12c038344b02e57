#pragma once

#include <time.h>

#include <cstdint>

/// Processor time of this thread: what other programs take from it does not count.

inline std::int64_t thread_ns() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return std::int64_t{1000000000} * now.tv_sec + now.tv_nsec;
}

inline double thread_us() { return 1e-3 * static_cast<double>(thread_ns()); }
