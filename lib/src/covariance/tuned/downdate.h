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
  bool far;  ///< the triangle is too large for the caches near the core: ask for it early
};

/// Tile (8 rows of a group from row i) x (columns from j):  P -= A^T B - U^T G - G^T U, the sum formed in registers from zero, so that
/// each element of P is rounded once. A and B are W's columns from i and from j, or stand-ins for them.
template <class V, int kVectors>
PF_INLINE void downdate_tile(const Thin& t, const Scalar* A, std::ptrdiff_t a_stride, const Scalar* B,
                             std::ptrdiff_t b_stride, Scalar* to, std::ptrdiff_t stride, int i, int j) {
#pragma GCC unroll 1
  for (int half = 0; half < kGroup; half += kTileRows) {
    Tile<V, kTileRows, kVectors> tile;
    if (t.far) tile.prefetch(to + half * stride, stride);
    tile.zero();
    tile.accumulate(A + half, 1, a_stride, B, b_stride, t.m);
    if (t.k > 0) {
      tile.template accumulate<true>(t.U + i + half, 1, t.ld, t.G + j, t.ld, t.k);
      tile.template accumulate<true>(t.G + i + half, 1, t.ld, t.U + j, t.ld, t.k);
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
    for (int j = first; j < reach; j += kColumns) {
      for (int q = block > j / kGroup ? block : j / kGroup; q < end; ++q) {
        const std::ptrdiff_t stride = kGroup * (q + 1);
        const int columns = smaller(kColumns, smaller(last, kGroup * (q + 1)) - j);
        Scalar* rows = P.data + group_offset(q);
        for_strips(j, columns, [&](auto v, auto count, int at) PF_LAMBDA {
          downdate_tile<decltype(v), decltype(count)::value>(t, t.W + q * kGroup, t.ld, t.W + at, t.ld, rows + at,
                                                             stride, q * kGroup, at);
        });
        if (j + columns == stride) clear_upper(P, q);
      }
    }
  }
}

}  // namespace
}  // namespace pf
