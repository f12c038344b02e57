#include "histogram.h"

#include <algorithm>
#include <cmath>

namespace pf::capture {

namespace {

/// Bin of the nearest rank: the first at which the counts reach share of all.
template <class Bins>
size_t bin_of_rank(const Bins& bins, int64_t count, double share) {
  const auto rank = std::max<int64_t>(1, static_cast<int64_t>(std::ceil(share * static_cast<double>(count))));
  int64_t sum = 0;
  for (size_t i = 0; i < bins.size(); ++i) {
    sum += bins[i];
    if (sum >= rank) {
      return i;
    }
  }
  return bins.size() - 1;
}

}  // namespace

void Histogram::add(double value) {
  smallest_ = count_ == 0 ? value : std::min(smallest_, value);
  largest_ = count_ == 0 ? value : std::max(largest_, value);
  ++count_;
  const double at = value > 0.0 ? kPerOctave * (std::log2(value) - kFirstOctave) : 0.0;
  ++bins_[static_cast<size_t>(std::clamp(at, 0.0, static_cast<double>(kBins - 1)))];
}

double Histogram::quantile(double share) const {
  if (count_ == 0) {
    return 0.0;
  }
  const auto bin = static_cast<double>(bin_of_rank(bins_, count_, share));
  return std::clamp(std::exp2((bin + 0.5) / kPerOctave + kFirstOctave), smallest_, largest_);
}

void CountHistogram::add(int32_t value) {
  const auto bin = static_cast<size_t>(std::max(value, 0));
  if (bin >= bins_.size()) {
    bins_.resize(bin + 1);
  }
  ++bins_[bin];
  ++count_;
}

double CountHistogram::quantile(double share) const {
  return count_ == 0 ? 0.0 : static_cast<double>(bin_of_rank(bins_, count_, share));
}

}  // namespace pf::capture
