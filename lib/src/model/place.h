#pragma once

#include "model/rows.h"

namespace pf {

/// Where a feature is: the direction in which a point c of W sees it, and what that depends on.
///
///   d = w (o - c) + b              w = 1 and b = 0 for all that has a place; an inverse depth has w = rho, and no place where rho <= 0
///
/// J_o and J_b are 3 x columns over the parts in their order; of them, w depends on w_column alone.
struct Place {
  static constexpr int kMaxParts = 3;
  static constexpr int kMaxColumns = 9;
  using Jacobian = Eigen::Matrix<Scalar, 3, kMaxColumns>;

  Vec3 o = Vec3::Zero();
  Vec3 b = Vec3::Zero();
  Scalar w = Scalar(1);
  int parts = 0;
  int columns = 0;
  int w_column = -1;  ///< -1: w is 1, and there is no b or J_b
  Part part[kMaxParts];
  Jacobian J_o, J_b;
  int plane = -1;        ///< slot of the plane that it lies on
  bool has_rows = true;  ///< false: the error of its own coordinates is in its value, and J_own leads from it to o
  Mat32 J_own = Mat32::Zero();

  template <int kSize>
  void append(int block, const Eigen::Matrix<Scalar, 3, kSize>& J) {
    part[parts++] = Part::of(block, 0, kSize);
    J_o.block<3, kSize>(0, columns) = J;
    columns += kSize;
  }

  /// Rows of axes o: J_out_o J_o over its parts. Only of a point (w = 1).
  template <int kRows>
  RowsOf<kRows, kMaxColumns, kMaxParts> rows(const Eigen::Matrix<Scalar, kRows, 3>& J_out_o) const {
    RowsOf<kRows, kMaxColumns, kMaxParts> J;
    J.parts = parts;
    for (int p = 0; p < parts; ++p) J.part[p] = part[p];
    for (int c = 0; c < columns; ++c) {
      const Eigen::Matrix<Scalar, kRows, 1> h = J_out_o * J_o.col(c);
      for (int r = 0; r < kRows; ++r) J.h[r * columns + c] = h(r);
    }
    return J;
  }

  /// Converts to a point o of W (w = 1, b = 0): o + b / w. False, with nothing changed, where there is none.
  bool resolve();
};

}  // namespace pf
