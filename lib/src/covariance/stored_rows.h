#pragma once

#include "covariance/kernels.h"

namespace pf {

/// Rows of a Jacobian with room of their own, for tests and benchmarks of the kernels.
struct StoredRows {
  int rows = 0;
  int segments = 0;
  Segment segment[SparseRows::kMaxSegments];
  Scalar h[SparseRows::kMaxRows * SparseRows::kMaxColumns];  ///< row-major, rows x columns()

  int columns() const { return view().columns(); }
  SparseRows view() const { return {rows, segments, segment, h}; }
  operator SparseRows() const { return view(); }
};

}  // namespace pf
