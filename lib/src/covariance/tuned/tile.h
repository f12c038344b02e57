#pragma once

#include "covariance/tuned/vector.h"

namespace pf {
namespace {

/// kRows x (kVectors * V::kWidth) block of a matrix that stays in registers while a product runs over it.
///
///            B, row k   | b0 | b1 | b2 |        loaded once per k
///   A(r, k)  splat      | c  | c  | c  |        kRows of them per k
template <class V, int kRowCount, int kVectorCount>
struct Tile {
  static constexpr int kRows = kRowCount;
  static constexpr int kVectors = kVectorCount;
  static constexpr int kColumns = kVectors * V::kWidth;
  using Type = typename V::Type;

  Type c[kRows][kVectors];

  PF_INLINE void zero() {
#pragma GCC unroll 8
    for (int r = 0; r < kRows; ++r) {
#pragma GCC unroll 8
      for (int v = 0; v < kVectors; ++v) c[r][v] = Type{};
    }
  }

  /// Prefetches the memory that the tile will be subtracted from when its product is done.
  static PF_INLINE void prefetch(const Scalar* to, std::ptrdiff_t stride) {
    constexpr int kLine = 64 / static_cast<int>(sizeof(Scalar));
#pragma GCC unroll 8
    for (int r = 0; r < kRows; ++r) {
#pragma GCC unroll 8
      for (int j = 0; j < kColumns; j += kLine) __builtin_prefetch(to + r * stride + j, 1);
    }
  }

  PF_INLINE void load(const Scalar* from, std::ptrdiff_t stride) {
#pragma GCC unroll 8
    for (int r = 0; r < kRows; ++r) {
#pragma GCC unroll 8
      for (int v = 0; v < kVectors; ++v) c[r][v] = V::load(from + r * stride + v * V::kWidth);
    }
  }

  PF_INLINE void store(Scalar* to, std::ptrdiff_t stride) const {
#pragma GCC unroll 8
    for (int r = 0; r < kRows; ++r) {
#pragma GCC unroll 8
      for (int v = 0; v < kVectors; ++v) V::store(to + r * stride + v * V::kWidth, c[r][v]);
    }
  }

  /// to -= c
  PF_INLINE void subtract_from(Scalar* to, std::ptrdiff_t stride) const {
#pragma GCC unroll 8
    for (int r = 0; r < kRows; ++r) {
#pragma GCC unroll 8
      for (int v = 0; v < kVectors; ++v) {
        Scalar* at = to + r * stride + v * V::kWidth;
        V::store(at, V::load(at) - c[r][v]);
      }
    }
  }

  /// c += A B over `count` terms, or c -= A B; A(r, k) = A[r a_row + k a_step], B's row k begins at B + k b_stride.
  template <bool kMinus = false>
  PF_INLINE void accumulate(const Scalar* A, std::ptrdiff_t a_row, std::ptrdiff_t a_step, const Scalar* B,
                            std::ptrdiff_t b_stride, int count) {
#pragma GCC unroll 2
    for (int k = 0; k < count; ++k) {
      Type b[kVectors];
#pragma GCC unroll 8
      for (int v = 0; v < kVectors; ++v) b[v] = V::load(B + v * V::kWidth);
#pragma GCC unroll 8
      for (int r = 0; r < kRows; ++r) {
        const Type a = A[r * a_row] - Type{};
#pragma GCC unroll 8
        for (int v = 0; v < kVectors; ++v) {
          c[r][v] = kMinus ? minus_product(a, b[v], c[r][v]) : plus_product(a, b[v], c[r][v]);
        }
      }
      A += a_step;
      B += b_stride;
    }
  }

  /// c <- L^-1 c for the lower triangle L (kRows x kRows, leading dimension l_stride).
  PF_INLINE void solve(const Scalar* L, std::ptrdiff_t l_stride) {
#pragma GCC unroll 8
    for (int r = 0; r < kRows; ++r) {
      const Type inverse = (1 / L[r * l_stride + r]) - Type{};
#pragma GCC unroll 8
      for (int v = 0; v < kVectors; ++v) c[r][v] *= inverse;
#pragma GCC unroll 8
      for (int s = r + 1; s < kRows; ++s) {
        const Type factor = L[s * l_stride + r] - Type{};
#pragma GCC unroll 8
        for (int v = 0; v < kVectors; ++v) c[s][v] = minus_product(factor, c[r][v], c[s][v]);
      }
    }
  }
};

/// Cut `columns` (a multiple of eight) into strips of kMost vectors, then into what is left. `work` is called with a tile's
/// columns as types, work(V{}, Count<vectors>{}, first column).
template <int kValue>
struct Count {
  static constexpr int value = kValue;
};

/// Whether strips of kMost vectors can leave so many vectors, but not one more, of columns that are a multiple of eight.
template <int kMost>
constexpr bool may_leave(int vectors) {
  constexpr int kWhole = kMost * Wide::kWidth;
  constexpr int kStep = kWhole % kGroup == 0 ? kGroup : kWhole % 4 == 0 ? 4 : kWhole % 2 == 0 ? 2 : 1;
  if (kMost > 5) return true;
  return kMost > vectors && ((vectors + 1) * Wide::kWidth - 1) / kStep * kStep >= vectors * Wide::kWidth;
}

template <int kMost = kTileVectors, class Work>
PF_INLINE void for_strips(int first, int columns, const Work& work) {
  int j = 0;
  for (; j + kMost * Wide::kWidth <= columns; j += kMost * Wide::kWidth) {
    work(Wide{}, Count<kMost>{}, first + j);
  }
  if (may_leave<kMost>(4) && j + 4 * Wide::kWidth <= columns) {
    work(Wide{}, Count<4>{}, first + j);
    j += 4 * Wide::kWidth;
  }
  if (may_leave<kMost>(3) && j + 3 * Wide::kWidth <= columns) {
    work(Wide{}, Count<3>{}, first + j);
    j += 3 * Wide::kWidth;
  }
  if (may_leave<kMost>(2) && j + 2 * Wide::kWidth <= columns) {
    work(Wide{}, Count<2>{}, first + j);
    j += 2 * Wide::kWidth;
  }
  if (may_leave<kMost>(1) && j + Wide::kWidth <= columns) {
    work(Wide{}, Count<1>{}, first + j);
    j += Wide::kWidth;
  }
  constexpr int kWide = Wide::kWidth, kNarrow = Narrow::kWidth;  // of one type where there is none narrower
  if ((kWide > kNarrow || kGroup % kWide != 0) && j < columns) work(Narrow{}, Count<1>{}, first + j);
}

/// Eight columns, in strips of two registers at most.
template <class Work>
PF_INLINE void for_eight(const Work& work) {
  constexpr int kVectors = smaller(2, kGroup / Narrow::kWidth);
  for (int j = 0; j < kGroup; j += kVectors * Narrow::kWidth) work(Narrow{}, Count<kVectors>{}, j);
}

/// Cut `rows` into tile heights, work(Count<rows>{}, first row).
template <int kMost = kTileRows, class Work>
PF_INLINE void for_heights(int rows, const Work& work) {
  int i = 0;
  for (; i + kMost <= rows; i += kMost) work(Count<kMost>{}, i);
  if (kMost > 4 && i + 4 <= rows) {
    work(Count<4>{}, i);
    i += 4;
  }
  if (kMost > 2 && i + 2 <= rows) {
    work(Count<2>{}, i);
    i += 2;
  }
  if (i < rows) work(Count<1>{}, i);
}

}  // namespace
}  // namespace pf
