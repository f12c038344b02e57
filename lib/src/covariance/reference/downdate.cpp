#include "covariance/reference/reference.h"

namespace pf::reference {

void downdate(Triangle& P, const Scalar* W, int m, const Scalar* U, const Scalar* G, int k, int ld, int active) {
  const std::ptrdiff_t stride = ld;
  for (int i = 0; i < P.n; ++i) {
    for (int j = 0; j <= i; ++j) {
      Scalar sum = 0;
      if (j < active) {
        for (int r = 0; r < m; ++r) sum += W[r * stride + i] * W[r * stride + j];
      }
      for (int r = 0; r < k; ++r) {
        sum -= U[r * stride + i] * G[r * stride + j] + G[r * stride + i] * U[r * stride + j];
      }
      P.row(i)[j] -= sum;
    }
  }
}

}  // namespace pf::reference
