#ifndef PLANEFOLD_CAPTURE_STEADY_H
#define PLANEFOLD_CAPTURE_STEADY_H

#include <cstdint>
#include <ctime>

namespace pf::capture {

/// CLOCK_MONOTONIC, which is also the clock of cameras [ns].
inline int64_t steady_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<int64_t>(now.tv_sec) * 1000000000 + now.tv_nsec;
}

}  // namespace pf::capture

#endif
