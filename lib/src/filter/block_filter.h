#pragma once

#include <cstddef>

#include "base/arena.h"
#include "covariance/kernels.h"
#include "filter/estimated_rows.h"
#include "filter/measurement.h"

namespace pf {

class Archive;

/// Rows from `begin` to before `end`.
struct RowRange {
  int begin = 0, end = 0;
};

/// Owns the covariance P and where each block's rows lie in it. It knows sizes and rows, no kinds and no values; nothing else writes P.
///
///   rows:  leading block (the body) | held (considered: covariance, but no gain of their own) | all others
///
/// The body's own considered rows are the first of the held ones.
class BlockFilter {
 public:
  static constexpr int kBatch = 16;  ///< blocks in one transform or hold
  struct Capacity {
    int dim;     ///< rows of the state
    int blocks;  ///< blocks that can have rows
    int rows;    ///< of one update
  };

  bool layout(Arena& arena, const Capacity& capacity);
  /// Begins with a leading block of so many estimated rows, and considered ones behind them.
  void init(const Kernels* kernels, int leading_dim, int considered);

  const Kernels& kernels() const { return *kernels_; }
  const Triangle& P() const { return P_; }
  int dim() const { return P_.n; }
  int leading_dim() const { return leading_dim_; }
  int held_dim() const { return held_dim_; }
  int held_end() const { return leading_dim_ + held_dim_; }
  RowRange held() const { return {leading_dim_, held_end()}; }
  int room() const { return max_dim_ - P_.n; }
  int max_rows() const { return max_rows_; }
  int ld() const { return ld_; }  ///< of thin matrices over the state

  int first(int block) const { return block == kBodyBlock ? 0 : at_[block].first; }
  int size(int block) const { return block == kBodyBlock ? leading_dim_ : at_[block].size; }
  int row(const Part& part) const { return first(part.block) + part.offset; }

  // --- moves of the covariance
  /// Gives the first `rows` rows of the leading block the covariance C (rows x rows, row-major) plus a dependence J on the rows behind them
  /// (rows x the others, row-major; null: independent): C + J P_o J^T, J P_o. Other blocks, which must be independent of the leading one,
  /// stay so.
  void set_leading(const Scalar* covariance, int rows, const Scalar* J);
  /// Considers so many of the leading block's last rows from now on, and estimates those before them.
  void consider_last(int rows);
  /// Sets the covariance of the leading block's rows from `first` on (row-major), independent of those before and of other blocks.
  void set_constants(int first, const Scalar* covariance);
  /// Predicts: x <- F x + noise Q for the first `rows` rows (both rows x rows, row-major).
  void predict(const Scalar* F, const Scalar* Q, int rows);
  /// Adds B c to the first `rows` rows, c the constants of the leading block from row `first` on (B: rows x columns, row-major).
  void add_constants(const Scalar* B, int rows, int first, int columns);
  /// Gives a block new rows J x + noise, behind all others, in place of those that it has.
  void augment(int block, const Rows& J, const Scalar* Q);
  /// The same with the sum of `count` Jacobians that together touch more blocks than one Rows can: J(k) -> Rows of `rows` rows over one
  /// part. The noise becomes Q plus own times the variance.
  template <typename Jacobian>
  void augment_dense(int block, int rows, int count, Jacobian&& J, Scalar* Q, Scalar own) {
    dense_begin(rows);
    for (int k = 0; k < count; ++k) dense_add(J(k));
    for (int k = 0; k < count; ++k) dense_square(J(k), Q);
    dense_end(block, rows, Q, own);
  }
  /// Replaces a block's rows by J x.
  void transform(int block, const Rows& J);
  /// The same for many blocks (at most kBatch) in one pass, all of them from the present state; they are left in the order of their rows.
  void transform(int* blocks, Rows* J, int count);
  /// Replaces rows of blocks by those of as many projected measurements, at the end of the held range.
  void hold(const int* blocks, int count);
  /// Removes the rows of blocks, in one pass; skips blocks without rows.
  void remove(const int* blocks, int count);
  /// Adds Q (size x size, row-major) to the covariance of a part.
  void inflate(const Part& part, const Scalar* Q);
  /// P += B B^T, with rows of B (size x 3, row-major) set for some parts between begin and end, and zero elsewhere.
  void begin_spread();
  void set_spread(const Part& part, const Scalar* rows);
  void end_spread();
  /// Inflates: J x, three rows, was wrong by sigma, which is added to its covariance, and to all else through its correlation with J x:
  ///   P += G diag(sigma^2) G^T,   G = P J^T (J P J^T)^-1
  void inflate_through(const Rows& J, const Vec3& sigma);
  /// P += P_xp M P_px, P_xp the columns of a part of three rows; M is symmetric and positive semidefinite.
  void inflate_by(const Part& part, const Mat3& M);
  /// The same along one row h of a Jacobian: the variance of h x grows by `variance`.
  void inflate_along(const Rows& row, Scalar variance);
  /// P += Uᵀ Q U. Q: U.rows squared, symmetric.
  void add_noise(const Rows& U, const Scalar* Q);
  /// P_ij <- f_i f_j P_ij: rows in other units.
  void scale_rows(const Scalar* factor) {
    for (int i = 0; i < P_.n; ++i)
      for (int j = 0; j <= i; ++j) P_.set(i, j, factor[i] * factor[j] * P_(i, j));
  }
  /// ld() numbers of the caller's until the next operation, all of them one.
  Scalar* row_factors() {
    std::fill(W_, W_ + ld_, Scalar(1));
    return W_;
  }

  /// P += U^T G + G^T U (both rows x ld()).
  void add_shared(const Scalar* U, const Scalar* G, int rows);
  /// P <- (I - N l) P (I - N l)^T + left N N^T, with N (ld() numbers) and l the sum of the rows of those k < count for which
  /// J(k, &row) is true, l N = 1. Returns l P l^T as it was.
  template <typename Jacobian>
  Scalar take_out(const Scalar* N, Scalar left, int count, Jacobian&& J) {
    ScaleRow row;
    dense_begin(1);
    for (int k = 0; k < count; ++k)
      if (J(k, &row)) dense_add(row);
    Scalar variance = 0;
    for (int k = 0; k < count; ++k)
      if (J(k, &row)) variance += dense_dot(row);
    take_out_dense(N, variance + left);
    return variance;
  }

  // --- soundness
  /// Lets variances grow by this share. Growth that a Scalar rounds to nothing beside 1 is accumulated until it does not.
  void grow(Scalar share) {
    owed_ += share;
    const Scalar factor = Scalar(1) + owed_;
    if (factor == Scalar(1)) return;
    owed_ = 0;
    for (int i = 0; i < P_.n; ++i) P_.set(i, i, factor * P_(i, i));
  }
  /// Raises variances that a downdate has left smaller than its rounding to the size of that. Invalidates the step.
  void keep_rounding();
  enum class Repair { kNone, kDone, kImpossible };
  /// Checks a sample of P, which depends on turn: the leading rows with some of the others. Where it is not positive semidefinite, beyond
  /// rounding, the variances of its rows grow until it is. Needs neither project() nor gain() kept.
  Repair repair(int turn);

  // --- update
  /// H P and S = H P H^T (without noise) of measurements, valid until the state changes.
  void project(const Measurement* z, int count);
  /// S of measurement i against j, of both heights, row-major.
  void innovation(int i, int j, Scalar* S) const;
  Mat2 innovation2(int i, int j) const;  ///< of two pixels
  /// Of two measurements of kRows rows.
  template <int kRows>
  Eigen::Matrix<Scalar, kRows, kRows> innovation_of(int i, int j) const {
    if constexpr (kRows == 2) return innovation2(i, j);
    Scalar S[kRows * kRows];
    innovation(i, j, S);
    return Eigen::Map<const Eigen::Matrix<Scalar, kRows, kRows>>(S).transpose();
  }
  /// Scratch of i + 1 numbers above the diagonal of S, 0 <= i < max_rows - 1: the caller's between project() and gain().
  Scalar* scratch_row(int i) { return S_ + (max_rows_ - 2 - i) * lds_ + (max_rows_ - 1 - i); }
  /// dx = P H^T (S + R)^-1 r of the projected measurements that are kept (null: all); zero for the rows that are considered, which at least
  /// held() are. Null when S + R cannot be factored or nothing is kept; P is as it was then. *nis gets r^T (S + R)^-1 r. What `partly`
  /// names stays valid until downdate().
  const Scalar* gain(const Measurement* z, int count, const unsigned char* keep, const RowRange& considered,
                     const PartlyConsidered& partly, Scalar* nis);
  /// dx of the last gain.
  const Scalar* step() const { return dx_; }
  /// Moves the last gain's step to another estimate, which differs by e in the leading rows.
  void shift_step(const Vec6& e) {
    for (int i = 0; i < 6; ++i) dx_[i] += e(i);
  }
  /// Invalidates the last gain.
  void forget_gain() { gained_ = 0; }
  /// Rows of L^-1 H P that the gain left, S + R = L L^T.
  const Scalar* whitened(int row) const { return W_ + row * ld_; }
  /// L^-1 (measured - predicted) of the same update: white where model and noise are right.
  const Scalar* whitened_innovation() const { return y_; }
  int gained_rows() const { return gained_; }
  /// Rows that the last gain considers.
  const RowRange& gain_considers() const { return gain_considers_; }
  /// P -= W^T W without what is considered, then P += U^T G + G^T U (both rows x ld()).
  void downdate(const Scalar* U, const Scalar* G, int rows);

  /// out = J P for Jacobians one below the other (leading dimension ld()).
  void gather(const Rows* J, int count, Scalar* out) const;
  /// J P J^T of a few rows, from the entries of P that they touch.
  template <int kRows>
  Eigen::Matrix<Scalar, kRows, kRows> covariance_of(const Rows& J) const;
  /// Of a single row.
  Scalar variance(const Rows& row) const;
  /// Bound of the rounding error of row r of J P J^T.
  Scalar rounding_of(const Rows& J, int r) const;
  /// Columns of the state that rows touch, in their order. Returns how many.
  int columns(const Rows& J, int* column) const;

  /// base/archive.h. The blocks are those of a state that has been carried.
  void carry(Archive& archive, const struct State& state);

 private:
  struct Located;  ///< rows as the kernels read them

  void locate(const Rows& J, Located* out) const;
  int put_estimating_first(const Measurement* z, int count, const unsigned char* keep);
  void swap_gained(int a, int b);
  void step_partly();
  void return_partly();
  void dense_begin(int rows);
  void dense_add(const Rows& J);
  void dense_square(const Rows& J, Scalar* Q) const;
  Scalar dense_dot(const Rows& J) const;
  void take_out_dense(const Scalar* N, Scalar factor);
  void dense_end(int block, int rows, Scalar* Q, Scalar own);
  void list_gone(int first, int size, int* gone);
  void close_gaps(int gone);
  void move_up(int gone);

  const Kernels* kernels_ = nullptr;
  Triangle P_;
  Segment* at_ = nullptr;  ///< of each block; size 0: no rows
  int blocks_ = 0;
  int leading_dim_ = 0, held_dim_ = 0;
  int considered_ = 0;  ///< of the held rows: those of the leading block
  int max_dim_ = 0;     ///< of the state; P_ has room for a few more
  int max_rows_ = 0;    ///< of one update
  int ld_ = 0, lds_ = 0;
  int gained_ = 0;
  RowRange gain_considers_;
  PartlyConsidered partly_;
  int estimating_ = 0;   ///< first rows of the gain that estimate what is partly considered
  Scalar owed_ = 0;      ///< accumulated growth, too small for a Scalar
  Scalar* W_ = nullptr;  ///< max_rows x ld: H P, then L^-1 H P
  Scalar* S_ = nullptr;  ///< max_rows x lds
  Scalar *dx_ = nullptr, *y_ = nullptr;
  Segment* gone_ = nullptr;
  int *order_ = nullptr, *row_ = nullptr;  ///< where rows go; where a measurement's rows begin
};

/// From the lower triangle of P:  S_rs = sum_i h_ri (P_ii h_si + p_s) + h_si p_r,   p_s = sum_{j<i} P_ij h_sj
template <int kRows>
Eigen::Matrix<Scalar, kRows, kRows> BlockFilter::covariance_of(const Rows& J) const {
  PF_ASSERT(J.rows == kRows);
  int column[SparseRows::kMaxColumns];
  const int count = columns(J, column);
  Eigen::Matrix<Scalar, kRows, kRows> S = Eigen::Matrix<Scalar, kRows, kRows>::Zero();
  for (int i = 0; i < count; ++i) {
    Scalar before[kRows] = {};
    for (int j = 0; j < i; ++j) {
      const Scalar p = P_(column[i], column[j]);
      for (int r = 0; r < kRows; ++r) before[r] += p * J.h[r * count + j];
    }
    const Scalar p = P_(column[i], column[i]);
    for (int r = 0; r < kRows; ++r) {
      const Scalar h_r = J.h[r * count + i];
      S(r, r) += h_r * (p * h_r + 2 * before[r]);
      for (int s = r + 1; s < kRows; ++s) {
        const Scalar h_s = J.h[s * count + i];
        S(r, s) += h_r * (p * h_s + before[s]) + h_s * before[r];
      }
    }
  }
  for (int r = 0; r < kRows; ++r)
    for (int s = 0; s < r; ++s) S(r, s) = S(s, r);
  return S;
}

/// Gives a block new rows that depend on nothing, with this covariance.
template <int kRows>
void augment_known(BlockFilter* blocks, int block, const Eigen::Matrix<Scalar, kRows, kRows>& covariance) {
  Rows known;
  known.rows = kRows;
  Scalar raw[kRows * kRows];
  put<kRows, kRows>(raw, kRows, 0, covariance);
  blocks->augment(block, known, raw);
}

}  // namespace pf
