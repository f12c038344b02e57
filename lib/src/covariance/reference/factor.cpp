#include <cmath>

#include "covariance/reference/reference.h"

namespace pf::reference {

bool cholesky(Scalar* S, int m, int lds) {
  const std::ptrdiff_t stride = lds;
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j <= i; ++j) {
      Scalar sum = S[i * stride + j];
      for (int k = 0; k < j; ++k) sum -= S[i * stride + k] * S[j * stride + k];
      if (j < i) {
        S[i * stride + j] = sum / S[j * stride + j];
      } else {
        if (!(sum > 0)) return false;
        S[i * stride + i] = std::sqrt(sum);
      }
    }
  }
  return true;
}

void solve_lower(const Scalar* L, int m, int lds, Scalar* X, int n, int ld) {
  const std::ptrdiff_t l_stride = lds;
  const std::ptrdiff_t x_stride = ld;
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < n; ++j) {
      Scalar sum = X[i * x_stride + j];
      for (int k = 0; k < i; ++k) sum -= L[i * l_stride + k] * X[k * x_stride + j];
      X[i * x_stride + j] = sum / L[i * l_stride + i];
    }
  }
}

}  // namespace pf::reference
