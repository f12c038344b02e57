#include "covariance/open_gap.h"

#include <cstring>

#include "base/assert.h"

namespace pf {

void open_gap(Triangle& P, int at, int size) {
  PF_ASSERT(at >= 0 && at <= P.n && size >= 0 && P.n + size <= P.capacity);
  const int n = P.n + size;
  for (int i = n - 1; i >= at; --i) {
    Scalar* to = P.row(i);
    const int width = Triangle::kGroup * (i / Triangle::kGroup + 1);
    const int from = i - size;
    if (from < at) {
      std::memset(to, 0, sizeof(Scalar) * static_cast<std::size_t>(width));
      continue;
    }
    // Row `from` ends before row i begins, whatever the groups.
    const Scalar* old = P.row(from);
    std::memcpy(to, old, sizeof(Scalar) * static_cast<std::size_t>(at));
    std::memset(to + at, 0, sizeof(Scalar) * static_cast<std::size_t>(size));
    std::memcpy(to + at + size, old + at, sizeof(Scalar) * static_cast<std::size_t>(from - at + 1));
    for (int j = i + 1; j < width; ++j) to[j] = 0;
  }
  const int padded_rows = (n + Triangle::kGroup - 1) / Triangle::kGroup * Triangle::kGroup;
  for (int i = n; i < padded_rows && i < P.capacity; ++i)
    std::memset(P.row(i), 0, sizeof(Scalar) * static_cast<std::size_t>(padded_rows));
  P.n = n;
}

}  // namespace pf
