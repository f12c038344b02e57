#include "filter/gauge_information.h"

#include <algorithm>
#include <cmath>

#include "filter/tuning.h"

namespace pf {
namespace {

using gauge::kDirections;
constexpr double kTolerance = sizeof(Scalar) == 8 ? 1e-10 : 1e-4;  ///< of a pivot, relative to its variance
/// Of variances: what rounding may have left missing (below).
const double kMissing =
    static_cast<double>(sizeof(Scalar) == 8 ? tuning::soundness::kRounding : tuning::soundness::kRoundingFloat);
constexpr int kColumns = 8;  ///< of N: the last one holds the variances

/// The directions as columns of N (n x 8, the last column zero), in double; zero where they are observable.
void directions(const State& state, const BlockFilter& blocks, double* N) {
  for (int i = 0; i < blocks.dim() * kColumns; ++i) N[i] = 0.0;
  const auto put_rows = [&](int first, int size, const auto& rows) {
    for (int i = 0; i < size; ++i)
      for (int d = 0; d < kDirections; ++d)
        if (gauge::contains(state.unobservable, d)) N[(first + i) * kColumns + d] = static_cast<double>(rows(i, d));
  };
  for_each_body_gauge(state.body, state.layout, state.mounting,
                      [&](int first, int size, const GaugeRowsOf<3>& rows) { put_rows(first, size, rows); });
  for (int s = 0; s < state.slots; ++s) {
    const Block& block = state.block[s];
    if (block.size == 0) continue;
    put_rows(blocks.first(s), block.size, gauge_rows(state, block));
  }
}

/// Where V is apart from the P of A = N^T P^-1 N:  N^T (P + N V N^T)^-1 N = (I + A V)^-1 A, by elimination with pivots.
void add_apart(const GaugePrior::Matrix& V, double* A) {
  constexpr int n = kDirections;
  double M[n][2 * n];
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      double sum = i == j ? 1 : 0;
      for (int k = 0; k < n; ++k) sum += A[i * n + k] * static_cast<double>(V(k, j));
      M[i][j] = sum;
      M[i][n + j] = A[i * n + j];
    }
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i)
      if (std::fabs(M[i][k]) > std::fabs(M[pivot][k])) pivot = i;
    std::swap_ranges(M[k], M[k] + 2 * n, M[pivot]);
    for (int i = 0; i < n; ++i) {
      if (i == k) continue;
      const double factor = M[i][k] / M[k][k];
      for (int j = k; j < 2 * n; ++j) M[i][j] -= factor * M[k][j];
    }
  }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) A[i * n + j] = (M[i][n + j] / M[i][i] + M[j][n + i] / M[j][j]) / 2;
}

/// A row without any error, as that of a lens coefficient whose variance is too small for a number, and that no direction changes.
bool is_exact(const double* S, const double* N, int row, int n) {
  const auto is_zero = [](double value) { return value == 0.0; };
  return std::all_of(S + row * n, S + (row + 1) * n, is_zero) &&
         std::all_of(N + row * kColumns, N + row * kColumns + kDirections, is_zero);
}

/// Row of the largest pivot that is left, relative to its variance. Negative where that is no more than the tolerance.
int next_pivot(const double* S, const double* N, int n) {
  int best = -1;
  double largest = kTolerance;
  for (int i = 0; i < n; ++i) {
    const double variance = N[i * kColumns + kDirections];
    if (variance > 0 && S[i * n + i] > largest * variance) {
      best = i;
      largest = S[i * n + i] / variance;
    }
  }
  return best;
}

/// Whether what is left of P, in rows that others determine, is that of a covariance to rounding.
bool is_nothing(const double* S, const double* N, int n) {
  for (int i = 0; i < n; ++i) {
    const double v_i = N[i * kColumns + kDirections];
    if (!(v_i > 0)) continue;
    if (!(S[i * n + i] > -kTolerance * v_i)) return false;
    for (int j = 0; j < i; ++j) {
      const double v_j = N[j * kColumns + kDirections];
      if (v_j > 0 && !(std::fabs(S[i * n + j]) <= 2 * kTolerance * std::sqrt(v_i) * std::sqrt(v_j))) return false;
    }
  }
  return true;
}

/// Eliminates one row after the other, that of the largest pivot first, so that rounding grows by nothing where P is nearly singular:
///
///   A += N_p^T N_p / S_pp,   N_i -= (S_ip / S_pp) N_p,   S_ij -= S_ip S_pj / S_pp,   S = P with P_ii (1 + growth) at first
///
/// A row that others determine (a new anchor is the body's position) adds no information; a pivot below zero means that P is no covariance.
bool eliminate(const Filter& filter, double growth, double* scratch, double* information) {
  const int n = filter.dim();
  double* S = scratch;
  double* N = scratch + static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) S[i * n + j] = S[j * n + i] = static_cast<double>(filter.covariance()(i, j));
  directions(filter.state(), filter.blocks(), N);
  for (int i = 0; i < n; ++i) {
    if (!(S[i * n + i] > 0) && !is_exact(S, N, i, n)) return false;
    S[i * n + i] += growth * S[i * n + i];
    N[i * kColumns + kDirections] = S[i * n + i];  // zero: nothing to eliminate
  }
  std::fill(information, information + kDirections * kDirections, 0.0);
  for (int p = next_pivot(S, N, n); p >= 0; p = next_pivot(S, N, n)) {
    const double* N_p = N + p * kColumns;
    const double pivot = S[p * n + p];
    for (int a = 0; a < kDirections; ++a)
      for (int b = 0; b < kDirections; ++b) information[a * kDirections + b] += N_p[a] * N_p[b] / pivot;
    N[p * kColumns + kDirections] = 0;  // done
    for (int i = 0; i < n; ++i) {
      if (!(N[i * kColumns + kDirections] > 0)) continue;
      const double factor = S[i * n + p] / pivot;
      for (int c = 0; c < kDirections; ++c) N[i * kColumns + c] -= factor * N_p[c];
      for (int j = 0; j < n; ++j) S[i * n + j] -= factor * S[p * n + j];
    }
  }
  return is_nothing(S, N, n);
}

}  // namespace

/// Each update rounds P - W^T W by epsilon P_ii, of the variance before it. Where that was v times the one after it, as where absurdly wide
/// priors meet good pixels, correlations are off by epsilon v, and P may have an eigenvalue below zero that no elimination can divide by.
/// What the end of a frame allows of that (BlockFilter::repair), with correlations C,
///
///   C + r I >= 0,   r = kMissing:   v up to r / epsilon, 5e9 in double
///
/// is allowed here too: the information is that of the smallest P that is a covariance for certain, P_ii (1 + r).
bool gauge_information(const Filter& filter, double* scratch, double information[49]) {
  if (!eliminate(filter, 0.0, scratch, information) && !eliminate(filter, kMissing, scratch, information)) return false;
  if (filter.apart().any()) add_apart(filter.apart().V(), information);
  return true;
}

}  // namespace pf
