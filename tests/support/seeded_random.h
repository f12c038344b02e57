#pragma once

// Random numbers that are the same on every machine (splitmix64), with their seed in the log.

#include <cmath>
#include <cstdint>
#include <cstdio>

#include "base/eigen.h"

namespace pf {

class SeededRandom {
 public:
  explicit SeededRandom(std::uint64_t seed) : state_(seed) {
    std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  }

  double uniform(double low, double high) { return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53; }

  /// Mean 0, variance 1 (Box-Muller).
  double normal() {
    const double radius = std::sqrt(-2 * std::log(uniform(1e-300, 1)));
    return radius * std::cos(uniform(0, 6.283185307179586));
  }

  template <int N>
  Eigen::Matrix<Scalar, N, 1> normals(double sigma) {
    Eigen::Matrix<Scalar, N, 1> v;
    for (int i = 0; i < N; ++i) v(i) = static_cast<Scalar>(sigma * normal());
    return v;
  }

 private:
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  std::uint64_t state_;
};

}  // namespace pf
