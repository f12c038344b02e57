#pragma once

#include <cstddef>

#include "base/always_inline.h"
#include "base/scalar.h"

namespace pf {

/// The lower triangle of a symmetric n x n matrix, packed in groups of eight rows.
///
///   rows 8q .. 8q+7 are stored with 8(q+1) columns each, so a group is a full-height panel and its diagonal 8x8 square is
///   whole (what lies above the diagonal in it is never read as a value, and may hold anything finite):
///
///     q=0  |8|            offset(i) = 32 q (q+1) + (i mod 8) * 8 (q+1),   q = i / 8
///     q=1  |8|8|
///     q=2  |8|8|8|        no two groups share a leading dimension, so none stays a power of two
///
/// Rows and columns are indices into the state; element (i, j) with j <= i.
struct Triangle {
  static constexpr int kGroup = 8;

  Scalar* data = nullptr;
  int n = 0;
  int capacity = 0;  ///< rows that data has room for, a multiple of kGroup

  static constexpr std::size_t size_for(int rows) {
    const std::size_t groups = static_cast<std::size_t>((rows + kGroup - 1) / kGroup);
    return 32 * groups * (groups + 1);
  }
  static constexpr PF_ALWAYS_INLINE std::size_t offset(int i) {
    const std::size_t q = static_cast<std::size_t>(i) / kGroup;
    return 32 * q * (q + 1) + (static_cast<std::size_t>(i) % kGroup) * kGroup * (q + 1);
  }

  PF_ALWAYS_INLINE Scalar* row(int i) { return data + offset(i); }
  PF_ALWAYS_INLINE const Scalar* row(int i) const { return data + offset(i); }
  PF_ALWAYS_INLINE Scalar operator()(int i, int j) const { return i >= j ? row(i)[j] : row(j)[i]; }
  PF_ALWAYS_INLINE void set(int i, int j, Scalar value) { (i >= j ? row(i)[j] : row(j)[i]) = value; }
};

}  // namespace pf
