#ifndef PLANEFOLD_CAPTURE_HISTOGRAM_H
#define PLANEFOLD_CAPTURE_HISTOGRAM_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pf::capture {

/// Quantiles of durations and other sizes in memory of fixed size, however many values come: counts in bins that are 0.55 % wide.
///
///   bin of x = floor(kPerOctave log2(x / 2^kFirstOctave)),   the quantile is the geometric middle of its bin: within 0.28 %
///
/// Smallest and largest value are exact, and no quantile lies outside of them. Values below 2^kFirstOctave, and negative ones,
/// count in the first bin, values from 2^kEndOctave on in the last.
class Histogram {
 public:
  void add(double value);
  /// Nearest rank, share 0 .. 1; 0 of nothing.
  double quantile(double share) const;
  double smallest() const { return count_ > 0 ? smallest_ : 0.0; }
  double largest() const { return count_ > 0 ? largest_ : 0.0; }

 private:
  static constexpr int kPerOctave = 126;
  static constexpr int kFirstOctave = -14;  ///< 61 ns, where values are milliseconds
  static constexpr int kEndOctave = 24;     ///< 4.7 hours
  static constexpr size_t kBins = static_cast<size_t>(kPerOctave * (kEndOctave - kFirstOctave));

  std::array<uint32_t, kBins> bins_{};
  int64_t count_ = 0;
  double smallest_ = 0.0, largest_ = 0.0;
};

/// Exact quantiles of whole numbers that have a bound, such as features and rows of the state: one counter for each number that came.
class CountHistogram {
 public:
  void add(int32_t value);
  /// Nearest rank, share 0 .. 1; 0 of nothing.
  double quantile(double share) const;
  double largest() const { return bins_.empty() ? 0.0 : static_cast<double>(bins_.size() - 1); }

 private:
  std::vector<uint32_t> bins_;  ///< up to the largest value
  int64_t count_ = 0;
};

}  // namespace pf::capture

#endif
