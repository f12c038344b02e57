#include "covariance/reference/reference.h"

namespace pf::reference {

void downdate(Triangle& P, const Scalar* W, int m, const Scalar* U, const Scalar* G, int k, int ld, int held_first,
              int held_end) {
  const std::ptrdiff_t stride = ld;
  const auto held = [&](int i) { return i >= held_first && i < held_end; };
  for (int i = 0; i < P.n; ++i) {
    for (int j = 0; j <= i; ++j) {
      Scalar sum = 0;
      if (!(held(i) && held(j))) {
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
