// What numbers that leave the library, or are about to, must be: finite, and covariances that are covariances.
#pragma once

#include <planefold/planefold.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/scalar.h"
#include "bytes.h"

constexpr double kSmallestEigenvalue = -1e-7;  ///< of a correlation matrix, which rounding may bring below zero
// Likewise as the estimate holds it. The body is checked and repaired in every frame, other rows in turns.
constexpr double kSmallestOfBody = sizeof(pf::Scalar) == sizeof(float) ? -1e-4 : -2e-6;
constexpr double kSmallestOfOthers = -1e-3;

inline bool finite(const double* values, int count) {
  return std::all_of(values, values + count, [](double v) { return std::isfinite(v); });
}

/// Smallest eigenvalue of the correlations of a covariance of up to 6 rows.
inline double smallest_eigenvalue(const double* covariance, int n) {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, 6, 6>;
  Matrix P = Eigen::Map<const Matrix>(covariance, n, n);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1> scale(n);
  for (int i = 0; i < n; ++i) scale(i) = P(i, i) > 0 ? 1 / std::sqrt(P(i, i)) : 0;
  P = scale.asDiagonal() * Matrix((P + P.transpose()) / 2) * scale.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Matrix>(P, Eigen::EigenvaluesOnly).eigenvalues()(0);
}

inline void require_covariance(const double* covariance, int n, const char* of) {
  require(finite(covariance, n * n), of);
  for (int i = 0; i < n; ++i) require(covariance[i * n + i] >= 0, of);
  const double smallest = smallest_eigenvalue(covariance, n);
  if (smallest < kSmallestEigenvalue) std::fprintf(stderr, "smallest eigenvalue %g\n", smallest);
  require(smallest >= kSmallestEigenvalue, of);
}

/// Of a covariance before it is mended for the caller.
template <class Matrix>
inline void require_nearly(const Matrix& covariance, double smallest_allowed, const char* of) {
  constexpr int n = Matrix::RowsAtCompileTime;
  double all[n * n];
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) all[i * n + j] = static_cast<double>(covariance(i, j));
  require(finite(all, n * n), of);
  for (int i = 0; i < n; ++i) {
    bool empty = true;  // exactly known
    for (int j = 0; j < n; ++j) empty = empty && all[i * n + j] == 0.0;
    require(empty || all[i * n + i] > 0.0, of);
    if (empty) all[i * n + i] = 1.0;
  }
  const double smallest = smallest_eigenvalue(all, n);
  if (smallest < smallest_allowed) std::fprintf(stderr, "smallest eigenvalue %g\n", smallest);
  require(smallest >= smallest_allowed, of);
}

inline void require_pose(const pf_pose_t& pose) {
  require(finite(pose.p_WC, 3) && finite(pose.v_W, 3) && finite(pose.w_C, 3) && finite(pose.q_WC, 4),
          "a pose is finite");
  double norm = 0;
  for (double q : pose.q_WC) norm += q * q;
  require(std::fabs(norm - 1) < 1e-4, "a quaternion has length 1");
  require_covariance(pose.covariance, 6, "a pose has a covariance");
}
