#pragma once

#include "base/eigen.h"

namespace pf {

/// Writes a small matrix into rows of a Jacobian (row-major, `stride` columns), from `column` on.
template <int Rows, int Columns>
inline void put(Scalar* h, int stride, int column, const Eigen::Matrix<Scalar, Rows, Columns>& J) {
  for (int i = 0; i < Rows; ++i)
    for (int j = 0; j < Columns; ++j) h[i * stride + column + j] = J(i, j);
}

}  // namespace pf
