#include <algorithm>

#include "filter/block_filter.h"
#include "filter/located.h"

/// What is known shrinks: of a part, and of all that has learnt from it.

namespace pf {

void BlockFilter::inflate(const Part& part, const Scalar* Q) {
  const int first = row(part);
  for (int i = 0; i < part.size; ++i)
    for (int j = 0; j <= i; ++j) P_.set(first + i, first + j, P_(first + i, first + j) + Q[i * part.size + j]);
}

void BlockFilter::add_noise(const Rows& U, const Scalar* Q) {
  const int columns = U.columns();
  const auto of_column = [&](int c) {
    int p = 0;
    for (; c >= U.part[p].size; ++p) c -= U.part[p].size;
    return row(U.part[p]) + c;
  };
  for (int a = 0; a < columns; ++a)
    for (int b = 0; b <= a; ++b) {
      Scalar sum = 0;
      for (int i = 0; i < U.rows; ++i)
        for (int j = 0; j < U.rows; ++j) sum += U.h[i * columns + a] * Q[i * U.rows + j] * U.h[j * columns + b];
      const int one = of_column(a), other = of_column(b);
      P_.set(std::max(one, other), std::min(one, other), P_(std::max(one, other), std::min(one, other)) + sum);
    }
}

void BlockFilter::begin_spread() {
  PF_ASSERT(max_rows_ >= 6);
  std::fill(W_, W_ + 3 * ld_, Scalar(0));
}

void BlockFilter::set_spread(const Part& part, const Scalar* rows) {
  for (int i = 0; i < part.size; ++i)
    for (int k = 0; k < 3; ++k) W_[k * ld_ + row(part) + i] = rows[3 * i + k];
}

void BlockFilter::end_spread() {
  Scalar* G = W_ + 3 * ld_;  // U^T G + G^T U with G = U / 2, as the downdate takes it
  for (int j = 0; j < 3 * ld_; ++j) G[j] = W_[j] / 2;
  kernels_->downdate(P_, W_, 0, W_, G, 3, ld_, 0, 0);
}

void BlockFilter::inflate_through(const Rows& J, const Vec3& sigma) {
  PF_ASSERT(J.rows == 3 && max_rows_ >= 9);
  constexpr Scalar kRidge = sizeof(Scalar) == 8 ? Scalar(1e-9) : Scalar(1e-4);  ///< of correlations: S may be singular
  const Mat3 S = covariance_of<3>(J);
  gather(&J, 1, W_);  // J P
  Vec3 scale;
  for (int i = 0; i < 3; ++i) scale(i) = Scalar(1) / std::sqrt(S(i, i));
  Mat3 C = scale.asDiagonal() * S * scale.asDiagonal();
  C.diagonal().array() += kRidge;
  const Mat3 inverse = C.inverse();
  Scalar *U = W_ + 3 * ld_, *G = W_ + 6 * ld_;  // P += U^T U, as the downdate takes it: U^T G + G^T U with G = U / 2
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < ld_; ++j) {
      Scalar sum = 0;
      for (int k = 0; k < 3; ++k) sum += inverse(i, k) * scale(k) * W_[k * ld_ + j];
      U[i * ld_ + j] = sigma(i) * scale(i) * sum;
      G[i * ld_ + j] = U[i * ld_ + j] / 2;
    }
  kernels_->downdate(P_, W_, 0, U, G, 3, ld_, 0, 0);
}

void BlockFilter::inflate_by(const Part& part, const Mat3& M) {
  PF_ASSERT(part.size == 3 && max_rows_ >= 6);
  RowsOf<3, 3, 1> J;
  J.parts = 1;
  J.part[0] = part;
  put<3, 3>(J.h, 3, 0, Mat3::Identity());
  const Rows rows = J;
  gather(&rows, 1, W_);  // P_px
  Scalar* G = W_ + 3 * ld_;
  for (int j = 0; j < ld_; ++j)
    for (int i = 0; i < 3; ++i)
      G[i * ld_ + j] = (M(i, 0) * W_[j] + M(i, 1) * W_[ld_ + j] + M(i, 2) * W_[2 * ld_ + j]) / 2;
  kernels_->downdate(P_, W_, 0, W_, G, 3, ld_, 0, 0);
}

}  // namespace pf
