#pragma once

#include "base/assert.h"
#include "base/eigen.h"
#include "covariance/kernels.h"

namespace pf {

/// Writes a small matrix into rows of a Jacobian (row-major, `stride` columns), from `column` on.
template <int Rows, int Columns>
inline void put(Scalar* h, int stride, int column, const Eigen::Matrix<Scalar, Rows, Columns>& J) {
  for (int i = 0; i < Rows; ++i)
    for (int j = 0; j < Columns; ++j) h[i * stride + column + j] = J(i, j);
}

/// Adds to a single row what it has over one more segment, into the columns that it has already where they are the same.
inline void add_segment(SparseRows* row, const Segment& segment, const Scalar* h) {
  int at = 0, column = 0;
  while (at < row->segments && row->segment[at].first != segment.first) column += row->segment[at++].size;
  if (at == row->segments) {
    PF_ASSERT(row->segments < SparseRows::kMaxSegments);
    row->segment[row->segments++] = segment;
    for (int i = 0; i < segment.size; ++i) row->h[column + i] = Scalar(0);
  }
  for (int i = 0; i < segment.size; ++i) row->h[column + i] += h[i];
}

}  // namespace pf
