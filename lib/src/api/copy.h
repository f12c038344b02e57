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

/// A covariance, n x n, for the caller: finite, symmetric, positive semidefinite, and zero only in rows that are zero. Rounding may leave
/// something else. Where the two sides of the diagonal differ, their mean counts. A variance that is not positive is wrong by its own size
/// at least, and at least as large as its covariances need:
///
///   v_i <- max(|v_i|, max_j c_ij^2 / v_j),   |c_ij| <= sqrt(v_i v_j)
///
/// and the variances grow until there is a Cholesky factor. A row with a number that is not finite is unknown: kMaxVariance.
inline void repair_covariance(double* C, int n) {
  constexpr double kTolerance = 1e-9, kStep = 4;
  bool lost[kMaxCovariance];
  for (int i = 0; i < n; ++i) {
    double* row = C + i * n;
    if (!finite(row, n))
      for (int j = 0; j < n; ++j) row[j] = C[j * n + i] = i == j ? kMaxVariance : 0.0;
    lost[i] = !(row[i] > 0.0);
    row[i] = std::fabs(row[i]);
  }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j) C[i * n + j] = C[j * n + i] = 0.5 * C[i * n + j] + 0.5 * C[j * n + i];
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n && lost[i]; ++j) {
      const double c = C[i * n + j], least = lost[j] ? std::fabs(c) : c / C[j * n + j] * c;
      if (least > C[i * n + i]) C[i * n + i] = std::fmin(least, kMaxVariance);
    }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double most = std::sqrt(C[i * n + i]) * std::sqrt(C[j * n + j]);
      if (i != j && std::fabs(C[i * n + j]) > most) C[i * n + j] = std::copysign(most, C[i * n + j]);
    }
  double grown = 0, factor = 1;
  while (!is_semidefinite(C, n, kTolerance / 2) && grown < n) {
    const double before = factor;
    grown = grown > 0 ? kStep * grown : kTolerance;
    factor = 1 + grown;
    for (int i = 0; i < n; ++i) C[i * n + i] *= factor / before;
  }
}

template <typename Matrix>
void copy_covariance(const Matrix& from, double* to) {
  constexpr int n = Matrix::RowsAtCompileTime;
  static_assert(n > 0 && n <= kMaxCovariance);
  copy_matrix(from, to);
  repair_covariance(to, n);
}

}  // namespace pf
