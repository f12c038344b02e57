#pragma once

#include <functional>
#include <string>
#include <vector>

namespace bench {

/// What is measured: `prepare` (not timed) restores the operands, `work` is timed.
struct Contender {
  std::string name;
  std::function<void()> prepare;
  std::function<void()> work;
};

/// Medians in microseconds, in the contenders' order. One repetition runs all of them, one after the other, so that what disturbs
/// the machine disturbs all alike; every run is preceded by an untimed one, or by a cold cache.
std::vector<double> medians(const std::vector<Contender>& contenders, int repetitions, bool cold = false);

/// Write all caches full of something else.
void flush_caches();

}  // namespace bench
