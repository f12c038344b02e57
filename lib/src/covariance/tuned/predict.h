#pragma once

#include "covariance/tuned/tile.h"

namespace pf {
namespace {

constexpr int kLeading = Kernels::kMaxLeading;

/// to (8 x columns, leading dimension kLeading) = A (8 x columns, stride a_stride) B (columns x columns, leading kLeading)
PF_INLINE void multiply_rows(const Scalar* A, std::ptrdiff_t a_stride, const Scalar* B, int columns, Scalar* to,
                             std::ptrdiff_t stride) {
  for_strips<2>(0, columns, [&](auto v, auto count, int j) {
    for (int i = 0; i < kGroup; i += kTileRows) {
      Tile<decltype(v), kTileRows, decltype(count)::value> tile;
      tile.zero();
      tile.accumulate(A + i * a_stride, a_stride, 1, B + j, kLeading, columns);
      tile.store(to + i * stride + j, stride);
    }
  });
}

/// Twin: reference::predict. F is widened to a multiple of eight by the identity, so that whole vectors move and the columns
/// that only fill up stay what they are.
///
///   | P_bb |            F P_bb F^T + Q,  through copies
///   | P_xb | P_xx |     P_xb F^T, eight rows at a time
void predict(Triangle& P, const Scalar* F, const Scalar* Q, int b) {
  const int columns = round_up(b, kGroup);
  alignas(64) Scalar Ft[kLeading * kLeading];
  alignas(64) Scalar block[kLeading * kLeading];
  alignas(64) Scalar rows[kGroup * kLeading];
  alignas(64) Scalar moved[kGroup * kLeading];
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < columns; ++j) {
      Ft[i * kLeading + j] = Scalar(i == j);
      block[i * kLeading + j] = 0;
    }
  }
  for (int i = 0; i < b; ++i) {
    const Scalar* row = row_of(P, i);
    for (int j = 0; j < b; ++j) Ft[j * kLeading + i] = F[i * b + j];
    for (int j = 0; j <= i; ++j) block[i * kLeading + j] = block[j * kLeading + i] = row[j];
  }

  for (int i0 = 0; i0 < columns; i0 += kGroup) {
    for (int i = 0; i < kGroup; ++i) {
      for (int j = 0; j < columns; ++j) rows[i * kLeading + j] = Ft[j * kLeading + i0 + i];
    }
    multiply_rows(rows, kLeading, block, columns, moved, kLeading);
    multiply_rows(moved, kLeading, Ft, columns, rows, kLeading);
    for (int i = i0; i < smaller(i0 + kGroup, b); ++i) {
      Scalar* to = row_of(P, i);
      for (int j = 0; j <= i; ++j) to[j] = rows[(i - i0) * kLeading + j] + Q[i * b + j];
    }
  }

  // The group that b ends in keeps its rows before b, and its columns from b on; then whole groups.
  for (int x = b / kGroup * kGroup; x < P.n; x += kGroup) {
    Scalar* group = row_of(P, x);
    const std::ptrdiff_t stride = stride_of(x);
    const bool whole = x >= columns;
    for (int i = 0; i < kGroup; ++i) {
      copy_groups(rows + i * kLeading, group + i * stride, columns);
    }
    multiply_rows(rows, kLeading, Ft, columns, whole ? group : moved, whole ? stride : kLeading);
    for (int i = b - x; !whole && i < kGroup; ++i) {
      for (int j = 0; j < b; ++j) group[i * stride + j] = moved[i * kLeading + j];
    }
  }
}

}  // namespace
}  // namespace pf
