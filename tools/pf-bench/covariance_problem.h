#pragma once

#include <vector>

#include "covariance/kernels.h"
#include "covariance/stored_rows.h"

namespace bench {

using pf::Scalar;

constexpr int kBody = 13;   ///< rows of the body block
constexpr int kPoint = 3;   ///< rows of a feature, and of a plane
constexpr int kPlanes = 4;  ///< whose heights the shifts of the transport move, all over the state

/// Memory that begins at a multiple of 64 bytes.
class Aligned {
 public:
  explicit Aligned(std::size_t count);
  Scalar* data() { return data_; }
  const Scalar* data() const { return data_; }
  std::size_t size() const { return size_; }

 private:
  std::vector<Scalar> storage_;
  Scalar* data_;
  std::size_t size_;
};

/// A state of a body, a plane and points, and one frame's rows: two per observed point, which touch the body and the point, and
/// every tenth pair the plane as well.
///
///   state   | body 13 | plane 3 | point 3 | point 3 | ...
class Problem {
 public:
  Problem(int n, int m);

  /// P as it was at the beginning.
  void restore();

  /// gather, innovation, Cholesky, gain, state change, downdate. Rows held_first .. held_end - 1 are considered;
  /// transport: rank of the thin symmetric term.
  void update(const pf::Kernels& kernels, int held_first, int held_end, int transport);

  /// Textbook inputs for peers, dense and row-major.
  std::vector<Scalar> dense_covariance() const;
  std::vector<Scalar> dense_rows() const;

  int n, m, ld, lds;
  Aligned start, values, W, U, G, S;
  pf::Triangle P;
  std::vector<pf::StoredRows> stored;
  std::vector<pf::SparseRows> J;  ///< views of what is stored
  std::vector<Scalar> innovation, y, whitened, dx;
  Scalar variance;  ///< of each row's noise
};

/// Columns that an average row touches.
double touched_columns(const Problem& problem);

}  // namespace bench
