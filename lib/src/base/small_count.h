#pragma once

#include <cstdint>

namespace pf {

/// A count in two bytes, which stays at its largest value when it gets there.
class SmallCount {
 public:
  static constexpr int kMax = 65535;

  SmallCount() = default;
  SmallCount(int n) : n_(static_cast<std::uint16_t>(n < 0 ? 0 : n > kMax ? kMax : n)) {}
  operator int() const { return n_; }
  SmallCount& operator++() {
    if (n_ < kMax) ++n_;
    return *this;
  }

 private:
  std::uint16_t n_ = 0;
};

}  // namespace pf
