#pragma once

#include "covariance/tuned/tile.h"

namespace pf {
namespace {

/// Rows i .. i + kRows - 1 of a strip of X:  X_i <- L_ii^-1 (X_i - L_i,0..i-1 X_0..i-1), in registers.
template <class V, int kRows, int kVectors>
PF_INLINE void solve_tile(const Scalar* L, std::ptrdiff_t lds, Scalar* X, std::ptrdiff_t ld, int i) {
  Tile<V, kRows, kVectors> tile;
  tile.load(X + i * ld, ld);
  tile.template accumulate<true>(L + i * lds, lds, 1, X, ld, i);
  tile.solve(L + i * lds + i, lds);
  tile.store(X + i * ld, ld);
}

/// Twin: reference::solve_lower. Works on whole groups of eight columns, padding included. Rows of a tile wait for each other, so
/// tiles are flat: four rows at most, and as many vectors as the registers of a full tile.
void solve_lower(const Scalar* L, int m, int lds, Scalar* X, int n, int ld) {
  constexpr int kRows = smaller(4, kTileRows);
  constexpr int kVectors = kTileRows / kRows * kTileVectors;
  for_strips<kVectors>(0, round_up(n, kGroup), [&](auto v, auto count, int j) {
    for_heights<kRows>(m, [&](auto height, int i) PF_LAMBDA {
      solve_tile<decltype(v), decltype(height)::value, decltype(count)::value>(L, lds, X + j, ld, i);
    });
  });
}

/// Twin: reference::combine.
void combine(const Scalar* W, int m, int n, int ld, const Scalar* y, Scalar* x) {
  const int whole = n / kGroup * kGroup;
  for_strips<4>(0, whole, [&](auto v, auto count, int j) PF_LAMBDA {
    Tile<decltype(v), 1, decltype(count)::value> tile;
    tile.zero();
    tile.accumulate(y, 0, 1, W + j, ld, m);
    tile.store(x + j, 0);
  });
  for (int j = whole; j < n; ++j) {
    Scalar sum = 0;
    for (int r = 0; r < m; ++r) sum += W[static_cast<std::ptrdiff_t>(r) * ld + j] * y[r];
    x[j] = sum;
  }
}

/// Twin: reference::add_product.
void add_product(Scalar* C, int k, const Scalar* A, int lda, const Scalar* B, int m, int n, int ld) {
  for_strips(0, round_up(n, kGroup), [&](auto v, auto count, int j) {
    for_heights(k, [&](auto height, int i) PF_LAMBDA {
      Tile<decltype(v), decltype(height)::value, decltype(count)::value> tile;
      Scalar* to = C + static_cast<std::ptrdiff_t>(i) * ld + j;
      tile.load(to, ld);
      tile.accumulate(A + static_cast<std::ptrdiff_t>(i) * lda, lda, 1, B + j, ld, m);
      tile.store(to, ld);
    });
  });
}

/// L of a block of at most eight rows, in place. The symmetric square is kept whole in registers, widened by the identity, so that
/// row j is also what is left of column j:  l_j = a_j / sqrt(a_jj),  a_i -= l_ij l_j.
PF_INLINE bool cholesky_block(Scalar* S, int rows, std::ptrdiff_t lds) {
  constexpr int kVectors = kGroup / Narrow::kWidth;
  alignas(64) Scalar whole[kGroup * kGroup] = {};
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j <= i; ++j) whole[i * kGroup + j] = whole[j * kGroup + i] = S[i * lds + j];
  }
  for (int i = rows; i < kGroup; ++i) whole[i * kGroup + i] = 1;

  Tile<Narrow, kGroup, kVectors> a;
  a.load(whole, kGroup);
#pragma GCC unroll 8
  for (int j = 0; j < kGroup; ++j) {
    Scalar* l = whole + j * kGroup;
#pragma GCC unroll 4
    for (int v = 0; v < kVectors; ++v) Narrow::store(l + v * Narrow::kWidth, a.c[j][v]);
    if (!(l[j] > 0)) return false;
    const Narrow::Type inverse = (1 / square_root(l[j])) - Narrow::Type{};
#pragma GCC unroll 4
    for (int v = 0; v < kVectors; ++v) {
      a.c[j][v] *= inverse;
      Narrow::store(l + v * Narrow::kWidth, a.c[j][v]);
    }
#pragma GCC unroll 8
    for (int i = j + 1; i < kGroup; ++i) {
      const Narrow::Type factor = l[i] - Narrow::Type{};
#pragma GCC unroll 4
      for (int v = 0; v < kVectors; ++v) a.c[i][v] = minus_product(factor, a.c[j][v], a.c[i][v]);
    }
  }
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j <= i; ++j) S[i * lds + j] = whole[j * kGroup + i];
  }
  return true;
}

/// Take columns from .. from + terms - 1 of L out of the panel of `width` columns that begins at p:
///   S_ij -= sum_k L_ik L_jk,   i >= p,  p <= j < p + width,  j <= i
inline void cholesky_downdate(Scalar* S, int m, std::ptrdiff_t lds, int p, int width, int from, int terms) {
  constexpr int kChunk = 32;
  alignas(64) Scalar B[kChunk * kGroup] = {};
  for (int k = 0; k < terms; k += kGroup) {
    transpose_square(S + p * lds + from + k, lds, width, kGroup, B + k * kGroup, kGroup);
  }
  alignas(64) Scalar square[kGroup * kGroup];
  for_eight([&](auto v, auto count, int at) {
    for_heights(width, [&](auto height, int i) PF_LAMBDA {
      Tile<decltype(v), decltype(height)::value, decltype(count)::value> tile;
      tile.zero();
      tile.accumulate(S + (p + i) * lds + from, lds, 1, B + at, kGroup, terms);
      tile.store(square + i * kGroup + at, kGroup);
    });
    for_heights(m - p - width, [&](auto height, int i) PF_LAMBDA {
      const std::ptrdiff_t row = (p + width + i) * lds;
      Tile<decltype(v), decltype(height)::value, decltype(count)::value> tile;
      tile.zero();
      tile.accumulate(S + row + from, lds, 1, B + at, kGroup, terms);
      tile.subtract_from(S + row + p + at, lds);
    });
  });
  for (int i = 0; i < width; ++i) {
    for (int j = 0; j <= i; ++j) S[(p + i) * lds + p + j] -= square[i * kGroup + j];
  }
}

/// Twin: reference::cholesky. Panels of eight columns, from the left:
///
///   | L      |        1. the panel loses what the columns before it explain, in chunks that fit the stack
///   | L  S11 |        2. S11 = L11 L11^T
///   | L  S21 |        3. L21 = S21 L11^-T, eight rows at a time, transposed
bool cholesky(Scalar* S, int m, int leading) {
  const std::ptrdiff_t lds = leading;
  constexpr int kChunk = 32;
  for (int p = 0; p < m; p += kGroup) {
    const int width = smaller(kGroup, m - p);
    for (int from = 0; from < p; from += kChunk) {
      cholesky_downdate(S, m, lds, p, width, from, smaller(kChunk, p - from));
    }
    Scalar* diagonal = S + p * lds + p;
    if (!cholesky_block(diagonal, width, lds)) return false;
    for (int i = p + kGroup; i < m; i += kGroup) {
      const int rows = smaller(kGroup, m - i);
      alignas(64) Scalar T[kGroup * kGroup] = {};
      transpose_square(S + i * lds + p, lds, rows, kGroup, T, kGroup);
      for_eight([&](auto v, auto count, int j) {
        for_heights(kGroup, [&](auto height, int at) PF_LAMBDA {
          solve_tile<decltype(v), decltype(height)::value, decltype(count)::value>(diagonal, lds, T + j, kGroup, at);
        });
      });
      transpose_square(T, kGroup, kGroup, rows, S + i * lds + p, lds);
    }
  }
  return true;
}

}  // namespace
}  // namespace pf
