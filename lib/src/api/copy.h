#pragma once

#include "api/checks.h"

namespace pf {

/// Copies the library's numbers into the caller's doubles.
template <typename Vector>
void copy(const Vector& from, int count, double* to) {
  for (int i = 0; i < count; ++i) to[i] = static_cast<double>(from[i]);
}

/// Row-major.
template <typename Matrix>
void copy_matrix(const Matrix& from, double* to) {
  const int rows = static_cast<int>(from.rows()), columns = static_cast<int>(from.cols());
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) to[i * columns + j] = static_cast<double>(from(i, j));
}

/// A covariance, n x n with n <= 6. What rounding leaves of one may have an eigenvalue below zero (of its correlations, 1e-7 in float): its
/// variances grow by as much.
template <typename Matrix>
void copy_covariance(const Matrix& from, double* to) {
  constexpr int n = Matrix::RowsAtCompileTime;
  constexpr double kTolerance = 1e-9, kStep = 4;
  static_assert(n > 0 && n <= 6);
  copy_matrix(from, to);
  for (int i = 0; i < n; ++i)
    if (!(to[i * n + i] > 0.0))
      for (int j = 0; j < n; ++j) to[i * n + j] = to[j * n + i] = 0.0;
  double grown = 0, factor = 1;
  while (!is_semidefinite_or_zero(to, n, kTolerance / 2) && grown < n) {
    const double before = factor;
    grown = grown > 0 ? kStep * grown : kTolerance;
    factor = 1 + grown;
    for (int i = 0; i < n; ++i) to[i * n + i] *= factor / before;
  }
}

}  // namespace pf
