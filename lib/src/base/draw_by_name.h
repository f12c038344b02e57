#pragma once

#include <cstdint>

/// Random draws among things with names, the same on every machine. Each thing has a priority in each draw, and those of least priority
/// are drawn. One thing more or less changes the draws alone that it wins, where an index below the number of things changes them all.

namespace pf {

/// A bijection whose bits all depend on all bits of x (the last step of MurmurHash3).
inline std::uint32_t mix_bits(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x85ebca6bu;
  x ^= x >> 13;
  x *= 0xc2b2ae35u;
  return x ^ (x >> 16);
}

class DrawByName {
 public:
  /// One draw; every number is another.
  explicit DrawByName(std::uint32_t number) : key_(mix_bits(number + 0x9e3779b9u)) {}

  /// Of the thing with this name. Different for different names.
  std::uint32_t priority(int name) const { return mix_bits(static_cast<std::uint32_t>(name) * 0x9e3779b1u ^ key_); }

 private:
  std::uint32_t key_;
};

}  // namespace pf
