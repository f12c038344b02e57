#pragma once

#include <cstdint>

#include "base/assert.h"
#include "base/eigen.h"

/// Rows of a Jacobian over the state. They name blocks, not rows of the covariance, so they stay valid when rows move.

namespace pf {

inline constexpr int kBodyBlock = -1;  ///< the block that leads the state, in a Part

/// A run of columns: rows offset .. offset + size - 1 of a block.
struct Part {
  std::int16_t block, offset, size;

  static Part of(int block, int offset, int size) {
    return {static_cast<std::int16_t>(block), static_cast<std::int16_t>(offset), static_cast<std::int16_t>(size)};
  }
  static Part body(int offset, int size) { return of(kBodyBlock, offset, size); }
};

/// Dense over the columns of its parts, in their order. A view: the caller owns the data.
struct Rows {
  int rows = 0;
  int parts = 0;
  const Part* part = nullptr;
  const Scalar* h = nullptr;  ///< row-major, rows x columns()

  int columns() const {
    int sum = 0;
    for (int p = 0; p < parts; ++p) sum += part[p].size;
    return sum;
  }
};

/// Rows with room of their own.
template <int kRows, int kMaxColumns, int kMaxParts>
struct RowsOf {
  int parts = 0;
  Part part[kMaxParts];
  Scalar h[kRows * kMaxColumns];

  int columns() const { return view().columns(); }
  Rows view() const { return {kRows, parts, part, h}; }
  operator Rows() const { return view(); }
};

/// Writes a small matrix into rows of a Jacobian (row-major, `stride` columns), from `column` on.
template <int kRows, int kColumns>
inline void put(Scalar* h, int stride, int column, const Eigen::Matrix<Scalar, kRows, kColumns>& J) {
  for (int i = 0; i < kRows; ++i)
    for (int j = 0; j < kColumns; ++j) h[i * stride + column + j] = J(i, j);
}

/// Adds the columns of one more part to a single row, into existing columns where both begin at the same row.
template <int kMaxColumns, int kMaxParts>
inline void add_part(RowsOf<1, kMaxColumns, kMaxParts>* row, const Part& part, const Scalar* h) {
  int at = 0, column = 0;
  while (at < row->parts && (row->part[at].block != part.block || row->part[at].offset != part.offset))
    column += row->part[at++].size;
  if (at == row->parts) {
    PF_ASSERT(row->parts < kMaxParts && column + part.size <= kMaxColumns);
    row->part[row->parts++] = part;
    for (int i = 0; i < part.size; ++i) row->h[column + i] = Scalar(0);
  }
  for (int i = 0; i < part.size; ++i) row->h[column + i] += h[i];
}

/// A row that picks the world's log scale out of an error; no parts where there is none.
using ScaleRow = RowsOf<1, 12, 4>;

}  // namespace pf
