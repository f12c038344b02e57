#pragma once

#include "filter/filter.h"
#include "frame/ellipse.h"
#include "geometry/small_cholesky.h"

/// One-point consensus of measurements of any height.

namespace pf {

/// S^-1 of an innovation covariance, and r^T S^-1 r with it; in closed form for a pixel.
template <int kRows>
struct InnovationSolver {
  using Vector = Eigen::Matrix<Scalar, kRows, 1>;
  using Matrix = Eigen::Matrix<Scalar, kRows, kRows>;

  /// False where S is not positive definite.
  static bool invert(const Matrix& S, Matrix* inverse) {
    SmallCholesky<kRows> cholesky;
    if (!cholesky.factor(S)) return false;
    *inverse = cholesky.inverse();
    return true;
  }
  /// Huge where S is not positive definite.
  static Scalar distance2(const Vector& r, const Matrix& S) {
    SmallCholesky<kRows> cholesky;
    return cholesky.factor(S) ? r.dot(cholesky.template solve<1>(r)) : kNoDistance2;
  }
};

template <>
struct InnovationSolver<2> {
  static bool invert(const Mat2& S, Mat2* inverse) {
    const Scalar det = S(0, 0) * S(1, 1) - S(0, 1) * S(1, 0);
    *inverse << S(1, 1), -S(0, 1), -S(1, 0), S(0, 0);
    *inverse = *inverse / det;
    return true;
  }
  static Scalar distance2(const Vec2& r, const Mat2& S) { return squared_distance(r, S); }
};

/// Finds the largest set of measurements that are consistent with one of them (one-point RANSAC; Civera, Grasa, Davison, Montiel 2010).
/// Not random: every one is tried as the hypothesis, since with the joint S = H P H^T + R a trial needs blocks of S only. All of them have
/// the height of Observation (a MeasurementOf), whose chi-square bound gate is.
///
///   after i:   r_j|i = r_j - S_ji S_ii^-1 r_i,   S_j|i = S_jj - S_ji S_ii^-1 S_ij;   j is an inlier if r^T S_j|i^-1 r < gate
///
/// begin_update must hold the same observations. keep gets 1 for the inliers of the best hypothesis. Returns how many.
template <typename Observation>
int find_inliers(const Filter& filter, const Observation* observations, int count, Scalar gate, unsigned char* keep) {
  constexpr int kRows = Observation::kHeight;
  using Solver = InnovationSolver<kRows>;
  using Vector = Eigen::Matrix<Scalar, kRows, 1>;
  using Matrix = Eigen::Matrix<Scalar, kRows, kRows>;
  const BlockFilter& blocks = filter.blocks();
  for (int j = 0; j < count; ++j) keep[j] = 0;
  int best = -1, best_inliers = 0;
  Scalar best_sum = 0;
  for (int pass = 0; pass < 2; ++pass) {
    for (int i = 0; i < count; ++i) {
      if (pass == 1 && i != best) continue;
      const Matrix Sii = blocks.innovation_of<kRows>(i, i) + observations[i].R_gate;
      Matrix Sii_inverse;
      if (!Solver::invert(Sii, &Sii_inverse)) continue;
      const Vector ri = observations[i].measured - observations[i].predicted;
      const Vector a = Sii_inverse * ri;
      int inliers = 0;
      Scalar sum = 0;
      for (int j = 0; j < count; ++j) {
        bool is_inlier = true;
        if (j != i) {
          const Matrix Sji = blocks.innovation_of<kRows>(j, i);
          const Vector r = observations[j].measured - observations[j].predicted - Sji * a;
          const Matrix S =
              blocks.innovation_of<kRows>(j, j) + observations[j].R_gate - Sji * Sii_inverse * Sji.transpose();
          const Scalar d2 = Solver::distance2(r, S);
          is_inlier = d2 < gate;
          if (is_inlier) sum += d2;
        }
        if (is_inlier) ++inliers;
        if (pass == 1) keep[j] = is_inlier ? 1 : 0;
      }
      if (pass == 0 && (inliers > best_inliers || (inliers == best_inliers && sum < best_sum))) {
        best = i;
        best_inliers = inliers;
        best_sum = sum;
      }
    }
  }
  return best_inliers;
}

}  // namespace pf
