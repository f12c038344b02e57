#pragma once

#include <cstdint>

/// Three different indices at a time, drawn at random and the same on every machine.

namespace pf {

class RandomTriples {
 public:
  /// Of the indices 0 .. count - 1, at least three.
  RandomTriples(int count, std::uint32_t seed) : count_(static_cast<std::uint32_t>(count)), state_(seed) {}

  std::uint32_t state() const { return state_; }  ///< a seed with which drawing goes on

  void draw(int three[3]) {
    three[0] = one();
    do three[1] = one();
    while (three[1] == three[0]);
    do three[2] = one();
    while (three[2] == three[0] || three[2] == three[1]);
  }

 private:
  int one() {
    state_ = state_ * 1664525u + 1013904223u;  // Numerical Recipes; the low bits have short periods
    return static_cast<int>((state_ >> 8) % count_);
  }

  std::uint32_t count_;
  std::uint32_t state_;
};

}  // namespace pf
