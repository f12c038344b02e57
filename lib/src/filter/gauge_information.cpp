#include "filter/gauge_information.h"

#include <algorithm>
#include <cmath>

#include "geometry/small_cholesky.h"

namespace pf {
namespace {

using gauge::kDirections;
constexpr double kTolerance = sizeof(Scalar) == 8 ? 1e-10 : 1e-4;  ///< of a pivot, relative to its variance

/// The directions as columns of N (n x 8, the last column unused), in double; zero where they are observable.
void directions(const State& state, const BlockFilter& blocks, double* N) {
  for (int i = 0; i < blocks.dim() * 8; ++i) N[i] = 0.0;
  const auto put_rows = [&](int first, int size, const auto& rows) {
    for (int i = 0; i < size; ++i)
      for (int d = 0; d < kDirections; ++d)
        if (gauge::contains(state.unobservable, d)) N[(first + i) * 8 + d] = static_cast<double>(rows(i, d));
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

}  // namespace

bool gauge_information(const Filter& filter, double* scratch, double information[49]) {
  const int n = filter.dim();
  double* L = scratch;
  double* N = scratch + static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) L[i * n + j] = static_cast<double>(filter.covariance()(i, j));
  directions(filter.state(), filter.blocks(), N);
  // A row that others determine (a new anchor is the body's position) says nothing new; one below zero is no covariance.
  if (!factor_semidefinite(L, n, kTolerance)) return false;
  for (int i = 0; i < n; ++i) {
    for (int c = 0; c < kDirections; ++c) {  // N <- L^-1 N, row by row
      double sum = N[i * 8 + c];
      for (int k = 0; k < i; ++k) sum -= L[i * n + k] * N[k * 8 + c];
      N[i * 8 + c] = L[i * n + i] > 0 ? sum / L[i * n + i] : 0.0;
    }
  }
  for (int a = 0; a < kDirections; ++a)
    for (int b = 0; b < kDirections; ++b) {
      double sum = 0;
      for (int i = 0; i < n; ++i) sum += N[i * 8 + a] * N[i * 8 + b];
      information[a * kDirections + b] = sum;
    }
  if (filter.apart().any()) add_apart(filter.apart().V(), information);
  return true;
}

}  // namespace pf
