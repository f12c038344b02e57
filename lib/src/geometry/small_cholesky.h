#pragma once

#include <cmath>
#include <limits>

#include "base/eigen.h"

/// Cholesky factorisations A = L Lᵀ of small symmetric matrices, without a heap: scaled, and of a size known at run
/// time. Only the lower triangle of A is read. Those of the state's size are kernels (covariance/kernels.h).

namespace pf {

/// A = L Lᵀ of a small symmetric positive definite matrix, for right sides of any fixed width, without a heap.
///
/// A is scaled to a unit diagonal first, so that rows in different units are judged alike:
/// A = D U D, D² = diag(A), U = L Lᵀ.
template <int N, typename T = Scalar>
class SmallCholesky {
 public:
  using Matrix = Eigen::Matrix<T, N, N>;

  /// False when A is not positive definite to working precision; nothing else may then be called.
  bool factor(const Matrix& A) {
    constexpr T kTiny = N * std::numeric_limits<T>::epsilon();
    for (int i = 0; i < N; ++i) {
      if (!(A(i, i) > 0) || !(A(i, i) <= std::numeric_limits<T>::max())) return false;
      scale_(i) = 1 / std::sqrt(A(i, i));
    }
    for (int j = 0; j < N; ++j) {
      for (int i = j; i < N; ++i) {
        T sum = A(i, j) * scale_(i) * scale_(j);
        for (int k = 0; k < j; ++k) sum -= L_(i, k) * L_(j, k);
        if (i == j) {
          if (!(sum > kTiny)) return false;
          L_(j, j) = std::sqrt(sum);
        } else {
          L_(i, j) = sum / L_(j, j);
        }
      }
    }
    return true;
  }

  /// A⁻¹ B.
  template <int M>
  Eigen::Matrix<T, N, M> solve(const Eigen::Matrix<T, N, M>& B) const {
    Eigen::Matrix<T, N, M> X;
    for (int c = 0; c < M; ++c) {
      for (int i = 0; i < N; ++i) {
        T sum = B(i, c) * scale_(i);
        for (int k = 0; k < i; ++k) sum -= L_(i, k) * X(k, c);
        X(i, c) = sum / L_(i, i);
      }
      for (int i = N - 1; i >= 0; --i) {
        T sum = X(i, c);
        for (int k = i + 1; k < N; ++k) sum -= L_(k, i) * X(k, c);
        X(i, c) = sum / L_(i, i);
      }
      for (int i = 0; i < N; ++i) X(i, c) *= scale_(i);
    }
    return X;
  }

  /// ln det A.
  T log_det() const {
    T sum = 0;
    for (int i = 0; i < N; ++i) sum += 2 * std::log(L_(i, i) / scale_(i));
    return sum;
  }

  /// L of A = L Lᵀ, without the scaling.
  Matrix lower() const {
    Matrix L = Matrix::Zero();
    for (int i = 0; i < N; ++i)
      for (int j = 0; j <= i; ++j) L(i, j) = L_(i, j) / scale_(i);
    return L;
  }

  /// A⁻¹, symmetric.
  Matrix inverse() const {
    const Matrix X = solve<N>(Matrix::Identity());
    Matrix S;
    for (int i = 0; i < N; ++i) {
      for (int j = 0; j < N; ++j) S(i, j) = (X(i, j) + X(j, i)) / 2;
    }
    return S;
  }

 private:
  Matrix L_ = Matrix::Zero();
  Eigen::Matrix<T, N, 1> scale_;
};

/// A = L Lᵀ in place (n x n, leading dimension ld), unscaled. False where a pivot is not positive; A is lost then.
template <typename T>
bool factor_cholesky(T* A, int n, int ld) {
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) {
      T sum = A[i * ld + j];
      for (int k = 0; k < j; ++k) sum -= A[i * ld + k] * A[j * ld + k];
      if (i == j) {
        if (!(sum > T(0))) return false;
        A[i * ld + i] = std::sqrt(sum);
      } else {
        A[i * ld + j] = sum / A[j * ld + j];
      }
    }
  }
  return true;
}

/// A⁻¹ b in place of b, with the factor that factor_cholesky leaves.
inline void solve_cholesky(const Scalar* L, int n, int ld, Scalar* b) {
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < i; ++k) b[i] -= L[i * ld + k] * b[k];
    b[i] /= L[i * ld + i];
  }
  for (int i = n - 1; i >= 0; --i) {
    for (int k = i + 1; k < n; ++k) b[i] -= L[k * ld + i] * b[k];
    b[i] /= L[i * ld + i];
  }
}

}  // namespace pf
