#include "base/assert.h"
#include "covariance/reference/reference.h"

namespace pf::reference {
namespace {

constexpr int kMaxRows = SparseRows::kMaxRows;

/// Zero what is stored behind the diagonal in row i; where the row opens a group, the whole group.
void clear_padding(Triangle& P, int i) {
  const int q = i / Triangle::kGroup;
  const int width = Triangle::kGroup * (q + 1);
  const int rows = i % Triangle::kGroup == 0 ? Triangle::kGroup : 1;
  for (int r = 0; r < rows; ++r) {
    for (int j = r == 0 ? i + 1 : 0; j < width; ++j) P.row(i + r)[j] = 0;
  }
}

}  // namespace

void predict(Triangle& P, const Scalar* F, const Scalar* Q, int b) {
  constexpr int kMax = Kernels::kMaxLeading;
  PF_ASSERT(b <= kMax && b <= P.n);

  Scalar FP[kMax * kMax];
  for (int i = 0; i < b; ++i) {
    for (int j = 0; j < b; ++j) {
      Scalar sum = 0;
      for (int k = 0; k < b; ++k) sum += F[i * b + k] * P(k, j);
      FP[i * b + j] = sum;
    }
  }
  for (int i = 0; i < b; ++i) {
    for (int j = 0; j <= i; ++j) {
      Scalar sum = 0;
      for (int k = 0; k < b; ++k) sum += FP[i * b + k] * F[j * b + k];
      P.set(i, j, sum + Q[i * b + j]);
    }
  }
  for (int x = b; x < P.n; ++x) {
    Scalar moved[kMax];
    for (int j = 0; j < b; ++j) {
      moved[j] = 0;
      for (int k = 0; k < b; ++k) moved[j] += P(x, k) * F[j * b + k];
    }
    for (int j = 0; j < b; ++j) P.set(x, j, moved[j]);
  }
}

void augment(Triangle& P, const SparseRows& J, const Scalar* noise) {
  PF_ASSERT(P.n + J.rows <= P.capacity);
  Scalar JPJ[kMaxRows * kMaxRows];
  square(J, P, JPJ);

  const int n = P.n;
  for (int a = 0; a < J.rows; ++a) {
    for (int j = 0; j < n; ++j) P.row(n + a)[j] = product(J, a, P, j);
    for (int b = 0; b <= a; ++b) P.row(n + a)[n + b] = JPJ[a * kMaxRows + b] + noise[a * J.rows + b];
    clear_padding(P, n + a);
  }
  P.n = n + J.rows;
}

/// A row x outside of the block takes its new entries from its own old ones alone, so rows may go one after the other in place;
/// the block with itself comes from J P J^T, which is formed before anything moves.
void replace(Triangle& P, int first, int size, const SparseRows& J, const Scalar* noise) {
  PF_ASSERT(J.rows <= size && first + size <= P.n);
  Scalar JPJ[kMaxRows * kMaxRows];
  square(J, P, JPJ);

  for (int x = 0; x < P.n; ++x) {
    if (x >= first && x < first + size) continue;
    Scalar moved[kMaxRows];
    for (int a = 0; a < J.rows; ++a) moved[a] = product(J, a, P, x);
    for (int a = 0; a < J.rows; ++a) P.set(x, first + a, moved[a]);
  }
  for (int a = 0; a < J.rows; ++a) {
    for (int b = 0; b <= a; ++b) {
      const Scalar added = noise != nullptr ? noise[a * J.rows + b] : Scalar(0);
      P.set(first + a, first + b, JPJ[a * kMaxRows + b] + added);
    }
  }
}

void transform(Triangle& P, int first, int size, const SparseRows& J, const Scalar* noise) {
  replace(P, first, size, J, noise);
  const Segment gap = {first + J.rows, size - J.rows};
  if (gap.size > 0) remove(P, &gap, 1);
}

void transform_many(Triangle& P, const Segment* block, const SparseRows* J, int count, Scalar* X, int ld, Scalar* S,
                    int lds) {
  gather_many(P, J, count, X, ld);
  int row = 0;
  for (int i = 0; i < count; ++i) row += J[i].rows;
  project(X, row, ld, J, count, S, lds);
  row = 0;
  for (int i = 0; i < count; ++i) {
    for (int a = 0; a < J[i].rows; ++a, ++row) {
      for (int x = 0; x < P.n; ++x) P.set(x, block[i].first + a, X[static_cast<std::ptrdiff_t>(row) * ld + x]);
    }
  }
  // Between two new rows the old state is on neither side.
  row = 0;
  for (int i = 0; i < count; ++i) {
    for (int a = 0; a < J[i].rows; ++a, ++row) {
      int column = 0;
      for (int g = 0; g <= i; ++g) {
        for (int b = 0; b < J[g].rows; ++b, ++column) {
          if (column > row) continue;
          P.set(block[i].first + a, block[g].first + b, S[static_cast<std::ptrdiff_t>(row) * lds + column]);
        }
      }
    }
  }
  for (int i = count - 1; i >= 0; --i) {
    const Segment gap = {block[i].first + J[i].rows, block[i].size - J[i].rows};
    if (gap.size > 0) remove(P, &gap, 1);
  }
}

void remove(Triangle& P, const Segment* gone, int count) {
  int kept = 0;
  int row_segment = 0;
  for (int i = 0; i < P.n; ++i) {
    while (row_segment < count && i >= gone[row_segment].first + gone[row_segment].size) ++row_segment;
    if (row_segment < count && i >= gone[row_segment].first) continue;
    int to = 0;
    int segment = 0;
    for (int j = 0; j <= i; ++j) {
      while (segment < count && j >= gone[segment].first + gone[segment].size) ++segment;
      if (segment < count && j >= gone[segment].first) continue;
      P.row(kept)[to++] = P.row(i)[j];
    }
    const int width = Triangle::kGroup * (kept / Triangle::kGroup + 1);
    for (int j = to; j < width; ++j) P.row(kept)[j] = 0;
    ++kept;
  }
  P.n = kept;
}

}  // namespace pf::reference
