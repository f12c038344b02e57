#pragma once

#include <cstddef>

#include "covariance/kernels.h"

/// The vectors that tuned kernels are written in, whose width the including file defines:
///
///   PF_VECTOR_BYTES   of a register
///   PF_TILE_ROWS      register tile: rows of the eight of a group (8, 4 or 2) ...
///   PF_TILE_VECTORS   ... times vectors across
/// and gives load_pieces for its registers, and plus_product(a, b, c) = c + a b and minus_product(a, b, c) = c - a b for each vector
/// type, in one rounding where the processor has it, and square_root of a scalar.
///
/// Everything in the headers of this folder lives in an unnamed namespace, once per kernel set, and calls no inline function from
/// elsewhere: the linker can never hand code for one processor to another. So rows are addressed by row_of and not by Triangle's
/// own members, and there is no Eigen and no C++ library.

#define PF_INLINE inline __attribute__((always_inline))
#define PF_LAMBDA __attribute__((always_inline))

namespace pf {
namespace {

constexpr int kGroup = Triangle::kGroup;

/// The compiler's vector types; `Loose` may lie anywhere. One by one, since the attributes cannot depend on a template's argument.
template <int kBytes>
struct Register;
template <>
struct Register<16> {
  typedef Scalar Type __attribute__((vector_size(16)));
  typedef Scalar Loose __attribute__((vector_size(16), aligned(sizeof(Scalar)), may_alias));
};
template <>
struct Register<32> {
  typedef Scalar Type __attribute__((vector_size(32)));
  typedef Scalar Loose __attribute__((vector_size(32), aligned(sizeof(Scalar)), may_alias));
};
template <>
struct Register<64> {
  typedef Scalar Type __attribute__((vector_size(64)));
  typedef Scalar Loose __attribute__((vector_size(64), aligned(sizeof(Scalar)), may_alias));
};

template <int kBytes>
struct Vector {
  static constexpr int kWidth = kBytes / static_cast<int>(sizeof(Scalar));
  using Type = typename Register<kBytes>::Type;
  using Loose = typename Register<kBytes>::Loose;

  static PF_INLINE Type load(const Scalar* from) { return *reinterpret_cast<const Loose*>(from); }
  static PF_INLINE void store(Scalar* to, const Type& value) { *reinterpret_cast<Loose*>(to) = value; }
};

/// Four rows of four scalars, `stride` apart, become four rows `to_stride` apart.
PF_INLINE void transpose_four(const Scalar* from, std::ptrdiff_t stride, Scalar* to, std::ptrdiff_t to_stride) {
  typedef Register<4 * sizeof(Scalar)> Four;
  const Four::Type a = *reinterpret_cast<const Four::Loose*>(from);
  const Four::Type b = *reinterpret_cast<const Four::Loose*>(from + stride);
  const Four::Type c = *reinterpret_cast<const Four::Loose*>(from + 2 * stride);
  const Four::Type d = *reinterpret_cast<const Four::Loose*>(from + 3 * stride);
  const Four::Type ab02 = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Four::Type ab13 = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Four::Type cd02 = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Four::Type cd13 = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  *reinterpret_cast<Four::Loose*>(to) = __builtin_shufflevector(ab02, cd02, 0, 1, 4, 5);
  *reinterpret_cast<Four::Loose*>(to + to_stride) = __builtin_shufflevector(ab13, cd13, 0, 1, 4, 5);
  *reinterpret_cast<Four::Loose*>(to + 2 * to_stride) = __builtin_shufflevector(ab02, cd02, 2, 3, 6, 7);
  *reinterpret_cast<Four::Loose*>(to + 3 * to_stride) = __builtin_shufflevector(ab13, cd13, 2, 3, 6, 7);
}

/// rows x columns (8 x 8 at most) become columns x rows.
PF_INLINE void transpose_square(const Scalar* from, std::ptrdiff_t stride, int rows, int columns, Scalar* to,
                                std::ptrdiff_t to_stride) {
  const int whole_rows = rows / 4 * 4;
  const int whole_columns = columns / 4 * 4;
  for (int r = 0; r < whole_rows; r += 4) {
    for (int c = 0; c < whole_columns; c += 4) {
      transpose_four(from + r * stride + c, stride, to + c * to_stride + r, to_stride);
    }
  }
  for (int r = 0; r < rows; ++r) {
    for (int c = r < whole_rows ? whole_columns : 0; c < columns; ++c) {
      to[c * to_stride + r] = from[r * stride + c];
    }
  }
}

/// Rows of the triangle are multiples of eight scalars long, which may be half of a register.
using Wide = Vector<PF_VECTOR_BYTES>;
constexpr int kNarrowBytes = Wide::kWidth > kGroup ? PF_VECTOR_BYTES / 2 : PF_VECTOR_BYTES;
using Narrow = Vector<kNarrowBytes>;

/// Sixteen bytes; wider registers have an overload in the file of their set, which takes as many pieces, `stride` apart.
template <class Type>
PF_INLINE Type load_pieces(const Scalar* from, std::ptrdiff_t, Type) {
  static_assert(sizeof(Type) == 16);
  return *reinterpret_cast<const Register<16>::Loose*>(from);
}

/// Of each pair of scalars the first ones, alternating between a and b, and the second ones.
template <int kWidth, class Type>
PF_INLINE void unpack(const Type& a, const Type& b, Type& first, Type& second) {
  if constexpr (kWidth == 2) {
    first = __builtin_shufflevector(a, b, 0, 2);
    second = __builtin_shufflevector(a, b, 1, 3);
  } else if constexpr (kWidth == 4) {
    first = __builtin_shufflevector(a, b, 0, 4, 2, 6);
    second = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  } else {
    first = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
    second = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
  }
}

/// The same for pairs of each four.
template <int kWidth, class Type>
PF_INLINE void unpack_pairs(const Type& a, const Type& b, Type& first, Type& second) {
  if constexpr (kWidth == 4) {
    first = __builtin_shufflevector(a, b, 0, 1, 4, 5);
    second = __builtin_shufflevector(a, b, 2, 3, 6, 7);
  } else {
    first = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
    second = __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
  }
}

/// One vector a column for the four columns that begin at `from`, of as many rows (`stride` apart) as a vector is wide: a
/// transposition in registers.
template <class V>
PF_INLINE void load_columns(const Scalar* from, std::ptrdiff_t stride, typename V::Type (&column)[4]) {
  constexpr int kWidth = V::kWidth;
  typename V::Type row[4], pair[4];
  if constexpr (sizeof(Scalar) == 8) {
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
      row[i] = load_pieces(from + i / 2 * 2 + i % 2 * stride, 2 * stride, typename V::Type{});
    }
    unpack<kWidth>(row[0], row[1], column[0], column[1]);
    unpack<kWidth>(row[2], row[3], column[2], column[3]);
  } else {
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) row[i] = load_pieces(from + i * stride, 4 * stride, typename V::Type{});
    unpack<kWidth>(row[0], row[1], pair[0], pair[1]);
    unpack<kWidth>(row[2], row[3], pair[2], pair[3]);
    unpack_pairs<kWidth>(pair[0], pair[2], column[0], column[2]);
    unpack_pairs<kWidth>(pair[1], pair[3], column[1], column[3]);
  }
}

/// Copy `count` scalars in whole eights, without a call: a library call for a few lines costs more than the copy.
PF_INLINE void copy_groups(Scalar* to, const Scalar* from, int count) {
  for (int j = 0; j < count; j += kGroup) {
#pragma GCC unroll 4
    for (int v = 0; v < kGroup; v += Narrow::kWidth) Narrow::store(to + j + v, Narrow::load(from + j + v));
    asm("" ::: "memory");  // keeps the compiler from making the call
  }
}

constexpr int kTileRows = PF_TILE_ROWS;
constexpr int kTileVectors = PF_TILE_VECTORS;

constexpr int round_up(int n, int to) { return (n + to - 1) / to * to; }

constexpr int smaller(int a, int b) { return a < b ? a : b; }

PF_INLINE std::ptrdiff_t group_offset(int q) { return 32 * static_cast<std::ptrdiff_t>(q) * (q + 1); }

/// Triangle::row, and the leading dimension of its group.
PF_INLINE int stride_of(int i) { return kGroup * (i / kGroup + 1); }

PF_INLINE Scalar* row_of(const Triangle& P, int i) {
  return P.data + group_offset(i / kGroup) + static_cast<std::ptrdiff_t>(i % kGroup) * stride_of(i);
}

PF_INLINE Scalar& element(const Triangle& P, int i, int j) { return i >= j ? row_of(P, i)[j] : row_of(P, j)[i]; }

PF_INLINE int columns_of(const SparseRows& J) {
  int sum = 0;
  for (int s = 0; s < J.segments; ++s) sum += J.segment[s].size;
  return sum;
}

}  // namespace
}  // namespace pf
