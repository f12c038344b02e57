#pragma once

#include <cmath>

#include "base/eigen.h"

namespace pf {

/// Eigenvalues of a symmetric 2x2 matrix, ascending.
inline Vec2 symmetric_eigenvalues(const Mat2& A) {
  const Scalar mean = (A(0, 0) + A(1, 1)) / 2, half = (A(0, 0) - A(1, 1)) / 2;
  const Scalar radius = std::sqrt(half * half + A(0, 1) * A(0, 1));
  return Vec2(mean - radius, mean + radius);
}

/// A = V diag(λ) Vᵀ of a symmetric 3x3 matrix, by Jacobi rotations: small eigenvalues are as accurate as large ones allow.
///
/// lambda  ascending
/// V       eigenvectors in its columns, orthonormal, det V = 1
inline void symmetric_eigen(const Mat3& A, Vec3* lambda, Mat3* V) {
  Mat3 D = A, Q = Mat3::Identity();
  for (int sweep = 0; sweep < 12; ++sweep) {
    const Scalar off = D(0, 1) * D(0, 1) + D(0, 2) * D(0, 2) + D(1, 2) * D(1, 2);
    if (!(off > 0)) break;
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        if (D(p, q) == 0) continue;
        // tan of the smaller angle that makes D(p, q) zero
        const Scalar half = (D(q, q) - D(p, p)) / (2 * D(p, q));
        const Scalar t = (half < 0 ? Scalar(-1) : Scalar(1)) / (std::abs(half) + std::sqrt(half * half + 1));
        const Scalar c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < 3; ++k) {
          const Scalar x = D(k, p), y = D(k, q);
          D(k, p) = c * x - s * y;
          D(k, q) = s * x + c * y;
        }
        for (int k = 0; k < 3; ++k) {
          const Scalar x = D(p, k), y = D(q, k);
          D(p, k) = c * x - s * y;
          D(q, k) = s * x + c * y;
        }
        D(p, q) = D(q, p) = 0;
        for (int k = 0; k < 3; ++k) {
          const Scalar x = Q(k, p), y = Q(k, q);
          Q(k, p) = c * x - s * y;
          Q(k, q) = s * x + c * y;
        }
      }
    }
  }
  int order[3] = {0, 1, 2};
  for (int i = 1; i < 3; ++i) {
    for (int k = i; k > 0 && D(order[k], order[k]) < D(order[k - 1], order[k - 1]); --k) {
      const int keep = order[k];
      order[k] = order[k - 1];
      order[k - 1] = keep;
    }
  }
  for (int i = 0; i < 3; ++i) {
    (*lambda)(i) = D(order[i], order[i]);
    V->col(i) = Q.col(order[i]);
  }
  if (V->col(0).cross(V->col(1)).dot(V->col(2)) < 0) V->col(2) = -V->col(2).eval();
}

}  // namespace pf
