#pragma once

#include "base/scalar.h"
#include "covariance/triangle.h"

/// The O(n^2) work on the covariance, as free functions over raw arrays. One table of function pointers per kernel set
/// (lib/docs/theory/kernels.md).
/// Thin matrices (rows m or k, columns n) are row-major with leading dimension ld >= padded(n): each row is contiguous in the
/// state index, and the padding columns are kept at zero by whoever owns the buffer.

namespace pf {

/// A run of columns of the state.
struct Segment {
  int first;
  int size;
};

/// Rows of a Jacobian that touch the same few columns: dense over the columns of its segments, in their order. A view: whoever makes
/// it keeps what it points to.
struct SparseRows {
  static constexpr int kMaxRows = 10;
  static constexpr int kMaxSegments = 8;
  static constexpr int kMaxColumns = 48;

  int rows = 0;
  int segments = 0;
  const Segment* segment = nullptr;
  const Scalar* h = nullptr;  ///< row-major, rows x columns()

  int columns() const {
    int sum = 0;
    for (int s = 0; s < segments; ++s) sum += segment[s].size;
    return sum;
  }
};

/// Leading dimension for thin matrices over n state rows: a multiple of eight, never of 64 (no power-of-two strides).
constexpr int padded(int n) {
  const int p = (n + 7) / 8 * 8;
  return p % 64 == 0 ? p + 8 : p;
}

struct Kernels {
  static constexpr int kMaxLeading = 32;
  static constexpr int kDenseRows = 4;   ///< of U; rows behind them cost nothing where whole tiles of them are zero
  static constexpr int kMaxMoved = 128;  ///< blocks in one transform_many

  /// out (rows x n) = J P, for rows of J that touch few columns. out has leading dimension ld.
  void (*gather)(const Triangle& P, const SparseRows& J, Scalar* out, int ld);

  /// S (m x m, lower, leading dimension lds) = L L^T in place; false where a pivot is not positive (S is then garbage).
  bool (*cholesky)(Scalar* S, int m, int lds);

  /// X (m x n) <- L^-1 X, in place, for the factor above. A vector is n = 1 with ld = padded(1).
  void (*solve_lower)(const Scalar* L, int m, int lds, Scalar* X, int n, int ld);

  /// P -= W^T W (W: m x n), then, where k > 0, P += U^T G + G^T U (U, G: k x n), in one pass over the triangle.
  /// Rows and columns held_first .. held_end - 1 are considered (Schmidt): where i and j both lie among them the first term is left
  /// out; the second is always applied. held_end <= held_first is the plain update. Rows of U from kDenseRows on should be zero but
  /// for a few columns, as the translations of planes are: tiles that they do not touch leave them out.
  void (*downdate)(Triangle& P, const Scalar* W, int m, const Scalar* U, const Scalar* G, int k, int ld, int held_first,
                   int held_end);

  /// Leading block of b rows moves by F (b x b, row-major), noise Q (b x b) is added:
  ///   P_bb <- F P_bb F^T + Q,  P_xb <- P_xb F^T,  b <= kMaxLeading.
  void (*predict)(Triangle& P, const Scalar* F, const Scalar* Q, int b);

  /// Append r new rows: x_new = J x + noise; r = J.rows, noise r x r row-major.  n grows by r.
  void (*augment)(Triangle& P, const SparseRows& J, const Scalar* noise);

  /// Replace the `size` rows that begin at `first` by the J.rows <= size new ones x_new = J x + noise (J may touch any columns, the
  /// old ones of this block too; noise may be null), then close the gap. Other rows keep their order.
  void (*transform)(Triangle& P, int first, int size, const SparseRows& J, const Scalar* noise);

  /// Remove the rows and columns of `count` ascending, disjoint segments in one pass.
  void (*remove)(Triangle& P, const Segment* gone, int count);

  /// gather for `count` Jacobians at once, their rows one below the other in out; what they share is read once.
  void (*gather_many)(const Triangle& P, const SparseRows* J, int count, Scalar* out, int ld);

  /// transform that leaves the gap open: rows first + J.rows .. first + size - 1 keep old values, for a later `remove` of the
  /// gaps of many replaces in one pass.
  void (*replace)(Triangle& P, int first, int size, const SparseRows& J, const Scalar* noise);

  /// transform for many blocks (ascending, disjoint, at most kMaxMoved) in one pass: block[i] becomes the J[i].rows <=
  /// block[i].size new rows J[i] x, all of them from the state as it was, and the gaps close. J[i].rows may be 0, which removes.
  /// With r the sum of the rows, X (r x n, leading dimension ld) and S (r x r, leading dimension lds) are scratch.
  void (*transform_many)(Triangle& P, const Segment* block, const SparseRows* J, int count, Scalar* X, int ld,
                         Scalar* S, int lds);

  /// S (lower triangle, leading dimension lds) = X J^T for X = J P (m x n, leading dimension ld) as gather_many leaves it, with the
  /// same Jacobians: the innovation covariance before the noise is added. Where X has more rows than J, those are gathered from
  /// further Jacobians, and S gets all m rows of the first columns only.
  void (*project)(const Scalar* X, int m, int ld, const SparseRows* J, int count, Scalar* S, int lds);

  /// x (n) = W^T y for W (m x n, leading dimension ld): the change of the state.
  void (*combine)(const Scalar* W, int m, int n, int ld, const Scalar* y, Scalar* x);

  /// C (k x n) += A (k x m, leading dimension lda) B (m x n); leading dimension ld of C and B, which do not overlap. Works on whole
  /// groups of eight columns, padding included.
  void (*add_product)(Scalar* C, int k, const Scalar* A, int lda, const Scalar* B, int m, int n, int ld);
};

/// The plain twin of every tuned kernel.
const Kernels& reference_kernels();

}  // namespace pf
