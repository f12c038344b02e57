#pragma once

#include "covariance/tuned/tile.h"

namespace pf {
namespace {

/// The thin factors of one downdate; leading dimension ld throughout.
struct Thin {
  const Scalar* W;
  int m;
  const Scalar* U;
  const Scalar* G;
  int k;
  std::ptrdiff_t ld;
  const unsigned char* touched;  ///< see below
  bool far;                      ///< the triangle is too large for the caches near the core: prefetch it
};

/// Which groups of columns hold anything in the rows of U behind the dense ones; those far behind count as if they did.
struct Touched {
  static constexpr int kGroups = 256;
  unsigned char any[kGroups];

  PF_INLINE void find(const Scalar* U, int k, std::ptrdiff_t ld, int groups) {
    for (int q = 0; q < smaller(groups, kGroups); ++q) {
      any[q] = 0;
      for (int r = Kernels::kDenseRows; r < k; ++r) {
        const Scalar* row = U + r * ld + q * kGroup;
        for (int j = 0; j < kGroup; ++j) any[q] |= static_cast<unsigned char>(row[j] != 0);
      }
    }
  }
};

/// How many rows of U count in groups first .. end - 1.
PF_INLINE int depth_of(const Thin& t, int first, int end) {
  if (t.k <= Kernels::kDenseRows || end > Touched::kGroups) return t.k;
  unsigned char any = 0;
  for (int q = first; q < end; ++q) any |= t.touched[q];
  return any != 0 ? t.k : Kernels::kDenseRows;
}

/// Rows of U to take for a tile, by what it holds in the tile's rows and in its columns.
struct Depth {
  int rows, columns;
};

/// Tile (8 rows of a group from row i) x (columns from j):  P -= A^T B - U^T G - G^T U, the sum formed in registers from zero, so that
/// each element of P is rounded once. A and B are W's columns from i and from j, or stand-ins for them.
template <class V, int kVectors>
PF_INLINE void downdate_tile(const Thin& t, const Depth& depth, const Scalar* A, std::ptrdiff_t a_stride,
                             const Scalar* B, std::ptrdiff_t b_stride, Scalar* to, std::ptrdiff_t stride, int i,
                             int j) {
#pragma GCC unroll 1
  for (int half = 0; half < kGroup; half += kTileRows) {
    Tile<V, kTileRows, kVectors> tile;
    if (t.far) tile.prefetch(to + half * stride, stride);
    tile.zero();
    tile.accumulate(A + half, 1, a_stride, B, b_stride, t.m);
    if (t.k > 0) {
      tile.template accumulate<true>(t.U + i + half, 1, t.ld, t.G + j, t.ld, depth.rows);
      tile.template accumulate<true>(t.G + i + half, 1, t.ld, t.U + j, t.ld, depth.columns);
    }
    tile.subtract_from(to + half * stride, stride);
  }
}

/// What lies above the diagonal in the diagonal square of group q is zero again.
PF_INLINE void clear_upper(const Triangle& P, int q) {
  const std::ptrdiff_t stride = kGroup * (q + 1);
  Scalar* square = P.data + group_offset(q) + q * kGroup;
#pragma GCC unroll 8
  for (int r = 0; r < kGroup; ++r) {
#pragma GCC unroll 8
    for (int c = r + 1; c < kGroup; ++c) square[r * stride + c] = 0;
  }
}

/// A part of the triangle: groups of rows first_group .. last_group - 1, columns first .. last - 1 (multiples of eight) where they
/// have them.
///
///   for blocks of kBlock groups, so that their part of W stays in the first cache
///     for strips of columns           P: |block row| -> -> ->
///       for the groups of the block
inline void downdate_part(const Triangle& P, const Thin& t, int first_group, int last_group, int first, int last) {
  constexpr int kBlock = 4;
  constexpr int kColumns = kTileVectors * Wide::kWidth;
  if (t.m == 0 && t.k == 0) return;
  for (int block = first_group; block < last_group; block += kBlock) {
    const int end = smaller(block + kBlock, last_group);
    const int reach = smaller(last, end * kGroup);
    int depth[kBlock];
    for (int q = block; q < end; ++q) depth[q - block] = depth_of(t, q, q + 1);
    for (int j = first; j < reach; j += kColumns) {
      const int depth_across = depth_of(t, j / kGroup, round_up(smaller(j + kColumns, reach), kGroup) / kGroup);
      for (int q = block > j / kGroup ? block : j / kGroup; q < end; ++q) {
        const std::ptrdiff_t stride = kGroup * (q + 1);
        const int columns = smaller(kColumns, smaller(last, kGroup * (q + 1)) - j);
        Scalar* rows = P.data + group_offset(q);
        for_strips(j, columns, [&](auto v, auto count, int at) PF_LAMBDA {
          downdate_tile<decltype(v), decltype(count)::value>(t, {depth[q - block], depth_across}, t.W + q * kGroup,
                                                             t.ld, t.W + at, t.ld, rows + at, stride, q * kGroup, at);
        });
        if (j + columns == stride) clear_upper(P, q);
      }
    }
  }
}

}  // namespace
}  // namespace pf
