#include "covariance/open_gap.h"

#include <cstring>

#include "base/assert.h"

namespace pf {
namespace {

std::size_t bytes(int count) { return sizeof(Scalar) * static_cast<std::size_t>(count); }

}  // namespace

void open_gap(Triangle& P, int at, int size, const Segment* gone, int count) {
  int left = size;  // how far the rows behind the segments that are still to come move back
  for (int g = 0; g < count; ++g) left -= gone[g].size;
  const int n = P.n + left;
  PF_ASSERT(at >= 0 && at <= P.n && left >= 0 && n <= P.capacity && (count == 0 || gone[0].first >= at));
  int g = count;
  for (int i = P.n - 1; i >= at; --i) {
    if (g > 0 && i < gone[g - 1].first + gone[g - 1].size) {
      left += gone[--g].size;
      i = gone[g].first;
      continue;
    }
    // Row i ends before row i + left begins, whatever the groups; where left is zero, runs move within the row, the last one first.
    const Scalar* from = P.row(i);
    Scalar* to = P.row(i + left);
    int end = i + 1, shift = left;
    for (int k = g; k >= 0; --k) {
      const int begin = k > 0 ? gone[k - 1].first + gone[k - 1].size : at;
      std::memmove(to + begin + shift, from + begin, bytes(end - begin));
      if (k == 0) break;
      end = gone[k - 1].first;
      shift += gone[k - 1].size;
    }
    if (to != from) std::memcpy(to, from, bytes(at));
    std::memset(to + at, 0, bytes(size));
    const int width = Triangle::kGroup * ((i + left) / Triangle::kGroup + 1);
    for (int j = i + left + 1; j < width; ++j) to[j] = 0;
  }
  for (int i = at; i < at + size; ++i) std::memset(P.row(i), 0, bytes(Triangle::kGroup * (i / Triangle::kGroup + 1)));
  const int padded_rows = (n + Triangle::kGroup - 1) / Triangle::kGroup * Triangle::kGroup;
  for (int i = n; i < padded_rows && i < P.capacity; ++i) std::memset(P.row(i), 0, bytes(padded_rows));
  P.n = n;
}

}  // namespace pf
