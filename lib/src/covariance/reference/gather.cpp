#include "covariance/reference/reference.h"

namespace pf::reference {

int state_column(const SparseRows& J, int column) {
  int s = 0;
  while (column >= J.segment[s].size) column -= J.segment[s++].size;
  return J.segment[s].first + column;
}

Scalar product(const SparseRows& J, int a, const Triangle& P, int j) {
  const int columns = J.columns();
  Scalar sum = 0;
  for (int c = 0; c < columns; ++c) sum += J.h[a * columns + c] * P(state_column(J, c), j);
  return sum;
}

void square(const SparseRows& J, const Triangle& P, Scalar* out) {
  const int columns = J.columns();
  for (int a = 0; a < J.rows; ++a) {
    for (int b = 0; b < J.rows; ++b) {
      Scalar sum = 0;
      for (int c = 0; c < columns; ++c) sum += product(J, a, P, state_column(J, c)) * J.h[b * columns + c];
      out[a * SparseRows::kMaxRows + b] = sum;
    }
  }
}

void gather(const Triangle& P, const SparseRows& J, Scalar* out, int ld) {
  for (int a = 0; a < J.rows; ++a) {
    for (int j = 0; j < P.n; ++j) out[a * static_cast<std::ptrdiff_t>(ld) + j] = product(J, a, P, j);
  }
}

void gather_many(const Triangle& P, const SparseRows* J, int count, Scalar* out, int ld) {
  for (int i = 0; i < count; ++i) {
    gather(P, J[i], out, ld);
    out += static_cast<std::ptrdiff_t>(J[i].rows) * ld;
  }
}

void project(const Scalar* X, int m, int ld, const SparseRows* J, int count, Scalar* S, int lds) {
  int b = 0;
  for (int i = 0; i < count; ++i) {
    const int columns = J[i].columns();
    for (int r = 0; r < J[i].rows; ++r, ++b) {
      for (int a = b; a < m; ++a) {
        Scalar sum = 0;
        for (int c = 0; c < columns; ++c) {
          sum += X[static_cast<std::ptrdiff_t>(a) * ld + state_column(J[i], c)] * J[i].h[r * columns + c];
        }
        S[static_cast<std::ptrdiff_t>(a) * lds + b] = sum;
      }
    }
  }
}

void combine(const Scalar* W, int m, int n, int ld, const Scalar* y, Scalar* x) {
  for (int j = 0; j < n; ++j) {
    x[j] = 0;
    for (int r = 0; r < m; ++r) x[j] += W[static_cast<std::ptrdiff_t>(r) * ld + j] * y[r];
  }
}

void add_product(Scalar* C, int k, const Scalar* A, int lda, const Scalar* B, int m, int n, int ld) {
  const std::ptrdiff_t stride = ld, a_stride = lda;
  for (int i = 0; i < k; ++i) {
    for (int j = 0; j < n; ++j) {
      Scalar sum = 0;
      for (int r = 0; r < m; ++r) sum += A[i * a_stride + r] * B[r * stride + j];
      C[i * stride + j] += sum;
    }
  }
}

}  // namespace pf::reference
