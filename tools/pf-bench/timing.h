#pragma once

#include <functional>
#include <string>
#include <vector>

namespace bench {

/// What is measured. Not timed: `restore` puts the operands back to what they were at the beginning; `prepare`, right before the
/// timed run, changes as little memory as it can, so that the cache stays as the untimed run before it left it.
struct Contender {
  std::string name;
  std::function<void()> restore;
  std::function<void()> prepare;
  std::function<void()> work;
};

/// Medians in microseconds, in the contenders' order. One repetition runs all of them, one after the other, so that what disturbs
/// the machine disturbs all alike; every run is preceded by an untimed one, or by a cold cache.
std::vector<double> medians(const std::vector<Contender>& contenders, int repetitions, bool cold = false);

/// Write all caches full of something else.
void flush_caches();

}  // namespace bench
