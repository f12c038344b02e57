#include "timing.h"

#include <algorithm>
#include <chrono>

namespace bench {

void flush_caches() {
  static std::vector<char> other(std::size_t{96} << 20);
  for (std::size_t i = 0; i < other.size(); i += 64) ++other[i];
}

std::vector<double> medians(const std::vector<Contender>& contenders, int repetitions, bool cold) {
  using Clock = std::chrono::steady_clock;
  std::vector<std::vector<double>> samples(contenders.size());
  for (int r = 0; r < repetitions; ++r) {
    for (std::size_t c = 0; c < contenders.size(); ++c) {
      const Contender& contender = contenders[c];
      contender.restore();
      if (!cold) contender.work();
      contender.prepare();
      if (cold) flush_caches();
      const auto begin = Clock::now();
      contender.work();
      const std::chrono::duration<double, std::micro> us = Clock::now() - begin;
      samples[c].push_back(us.count());
    }
  }
  std::vector<double> out;
  for (std::vector<double>& s : samples) {
    std::nth_element(s.begin(), s.begin() + static_cast<std::ptrdiff_t>(s.size() / 2), s.end());
    out.push_back(s[s.size() / 2]);
  }
  return out;
}

}  // namespace bench
