#pragma once

// Random covariances, Jacobians and thin matrices for the tests of the covariance kernels.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <vector>

#include "covariance/kernels.h"
#include "covariance/stored_rows.h"

namespace covariance_cases {

using pf::Scalar;

constexpr Scalar kNaN = std::numeric_limits<Scalar>::quiet_NaN();

/// splitmix64; the same numbers on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  int integer(int low, int high) { return low + static_cast<int>(bits() % static_cast<std::uint64_t>(high - low + 1)); }
  double uniform(double low, double high) { return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53; }
  double normal() {
    double sum = 0;
    for (int i = 0; i < 12; ++i) sum += uniform(-0.5, 0.5);
    return sum;
  }

 private:
  std::uint64_t state_;
};

/// A buffer that begins `shift` scalars behind an address that is a multiple of 64 and holds poison.
class Buffer {
 public:
  explicit Buffer(std::size_t count, int shift = 0, Scalar poison = kNaN) : storage_(count + 64, poison) {
    const std::size_t misplaced = reinterpret_cast<std::uintptr_t>(storage_.data()) % 64;
    const std::size_t skip = misplaced == 0 ? 0 : (64 - misplaced) / sizeof(Scalar);
    data_ = storage_.data() + skip + shift;
  }
  Scalar* data() { return data_; }
  const Scalar* data() const { return data_; }
  Scalar& operator[](std::size_t i) { return data_[i]; }

 private:
  std::vector<Scalar> storage_;
  Scalar* data_;
};

/// Thin matrix as the kernels want it: padding zero; poison in what is still to be written, and around.
struct Thin {
  int rows, columns, ld;
  Buffer values;
  Thin(int r, int n, int shift = 0, Scalar poison = kNaN)
      : rows(r), columns(n), ld(pf::padded(n)), values(static_cast<std::size_t>(r) * pf::padded(n), shift, poison) {
    for (int i = 0; i < rows; ++i) {
      for (int j = columns; j < ld; ++j) at(i, j) = 0;
    }
  }
  Scalar* data() { return values.data(); }
  Scalar& at(int i, int j) { return values[static_cast<std::size_t>(i) * ld + j]; }
  void randomise(Random& random, double scale) {
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < columns; ++j) at(i, j) = static_cast<Scalar>(scale * random.normal());
    }
  }
};

/// Rows from kDenseRows on keep up to three columns and are zero else, as shifts of planes are.
inline void keep_few(Random& random, Thin& U) {
  std::vector<bool> kept(static_cast<std::size_t>(U.columns), false);
  for (int i = random.integer(0, 3); i > 0; --i) kept[random.integer(0, U.columns - 1)] = true;
  for (int i = pf::Kernels::kDenseRows; i < U.rows; ++i) {
    for (int j = 0; j < U.columns; ++j) {
      if (!kept[j]) U.at(i, j) = 0;
    }
  }
}

/// A triangle over its own NaN-filled memory; what belongs to rows below n is finite, as augment leaves it.
struct Covariance {
  Buffer values;
  pf::Triangle P;
  explicit Covariance(int n, int capacity, int shift = 0, Scalar poison = kNaN)
      : values(pf::Triangle::size_for(capacity), shift, poison) {
    P.data = values.data();
    P.n = n;
    P.capacity = (capacity + 7) / 8 * 8;
    const int rows = (n + 7) / 8 * 8;
    for (std::size_t i = 0; i < pf::Triangle::size_for(rows); ++i) values[i] = 0;
  }
  void copy_from(const pf::Triangle& other) {
    for (int i = 0; i < other.n; ++i) {
      for (int j = 0; j <= i; ++j) P.row(i)[j] = other.row(i)[j];
    }
  }
};

/// Positive definite: P = D (A A^T / c + I / 10) D with standard deviations D between 0.01 and 10.
inline void randomise(Random& random, pf::Triangle& P) {
  constexpr int kFactors = 6;
  const int n = P.n;
  std::vector<double> A(static_cast<std::size_t>(n) * kFactors);
  std::vector<double> sigma(n);
  for (double& a : A) a = random.normal();
  for (double& s : sigma) s = std::pow(10.0, random.uniform(-2, 1));
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) {
      double sum = i == j ? 0.1 : 0;
      for (int c = 0; c < kFactors; ++c) sum += A[i * kFactors + c] * A[j * kFactors + c] / kFactors;
      P.row(i)[j] = static_cast<Scalar>(sigma[i] * sigma[j] * sum);
    }
  }
}

/// `rows` rows that touch up to `segments` random disjoint runs of the state, unordered; often the body first.
inline pf::StoredRows random_rows(Random& random, int rows, int n, int segments) {
  pf::StoredRows J;
  J.rows = rows;
  std::vector<bool> taken(n, false);
  int columns = 0;
  for (int s = 0; s < segments; ++s) {
    const bool body = s == 0 && random.integer(0, 2) > 0;
    int size = body ? std::min(n, 13) : random.integer(1, std::min(n, 6));
    if (columns + size > pf::SparseRows::kMaxColumns) break;
    const int first = body ? 0 : random.integer(0, n - size);
    bool free = true;
    for (int i = first; i < first + size; ++i) free = free && !taken[i];
    if (!free) continue;
    for (int i = first; i < first + size; ++i) taken[i] = true;
    J.segment[J.segments++] = {first, size};
    columns += size;
  }
  for (int i = 0; i < rows * columns; ++i) J.h[i] = static_cast<Scalar>(random.normal());
  return J;
}

/// What a kernel takes.
inline std::vector<pf::SparseRows> views(const std::vector<pf::StoredRows>& J) {
  return std::vector<pf::SparseRows>(J.begin(), J.end());
}

/// Largest |A_ij - B_ij| / sqrt(variance_i variance_j).
inline double difference(const pf::Triangle& A, const pf::Triangle& B, const std::vector<double>& variance) {
  if (A.n != B.n) return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (int i = 0; i < A.n; ++i) {
    for (int j = 0; j <= i; ++j) {
      const double d = std::fabs(static_cast<double>(A.row(i)[j]) - static_cast<double>(B.row(i)[j]));
      const double relative = d / std::sqrt(variance[i] * variance[j]);
      if (!(relative <= worst)) worst = relative;
    }
  }
  return worst;
}

constexpr bool kFloat = sizeof(Scalar) == 4;

}  // namespace covariance_cases
