#pragma once

#include "covariance/tuned/moves.h"

namespace pf {
namespace {

/// Copy `count` scalars and nothing behind them.
PF_INLINE void copy_exactly(Scalar* to, const Scalar* from, int count) {
  const int whole = count / kGroup * kGroup;
  copy_groups(to, from, whole);
  for (int j = whole; j < count; ++j) to[j] = from[j];
}

/// What a row is made of: `size` columns as they were, from column `from` to column `to`, then `rows` new ones.
struct Run {
  int from, to, size, rows;
};

/// The new rows of all blocks, and where they come from.
struct NewRows {
  const Segment* block;
  const SparseRows* J;
  int count;
  const Scalar* X;
  std::ptrdiff_t ld;
  const Scalar* S;
  std::ptrdiff_t lds;
  Run run[Kernels::kMaxMoved];  ///< up to each block, and its own

  PF_INLINE void list_runs() {
    for (int g = 0, from = 0, to = 0; g < count; ++g) {
      run[g] = {from, to, block[g].first - from, J[g].rows};
      from = block[g].first + block[g].size;
      to += run[g].size + run[g].rows;
    }
  }

  /// Row x, which is in no block and has `blocks` (one or more) of them before it: runs between blocks as they were, new columns from X.
  /// Runs may be copied in whole eights (`loose`) where what is written too much is overwritten later; see remove. A row that has not
  /// moved only takes the new columns.
  PF_INLINE void old_row(const Scalar* from, int x, int blocks, bool loose, Scalar* row) const {
    const Scalar* value = X + x;
    const Run* const end = run + blocks;
    for (const Run* r = run; r != end; ++r) {
      const int size = r->size, rows = r->rows;
      const Scalar* source = from + r->from;
      Scalar* to = row + r->to;
      if (loose) {
        copy_groups(to, source, size);
      } else if (row != from) {
        copy_exactly(to, source, size);
      }
      to += size;
      if (rows == 2) {  // as most are
        to[0] = value[0];
        to[1] = value[ld];
        value += 2 * ld;
        continue;
      }
      for (int b = 0; b < rows; ++b, value += ld) to[b] = *value;
    }
    const int begin = block[blocks - 1].first + block[blocks - 1].size;
    Scalar* to = row + end[-1].to + end[-1].size + end[-1].rows;
    if (loose) {
      copy_groups(to, from + begin, x + 1 - begin);
    } else if (row != from) {
      copy_exactly(to, from + begin, x + 1 - begin);
    }
  }

  /// Row a of block i, which is row r of X and S.
  PF_INLINE void new_row(int i, int a, int r, Scalar* row) const {
    const Scalar* from = X + r * ld;
    const Scalar* value = S + r * lds;
    int to = 0, next = 0;
    for (int g = 0; g <= i; ++g) {
      const int size = block[g].first - next;
      copy_exactly(row + to, from + next, size);
      to += size;
      const int columns = g < i ? J[g].rows : a + 1;
      for (int b = 0; b < columns; ++b) row[to++] = *value++;
      next = block[g].first + block[g].size;
    }
  }
};

/// Twin: reference::transform_many. Rows only ever move towards the front, so one pass in place is enough: what a new row needs was
/// gathered before.
void transform_many(Triangle& P, const Segment* block, const SparseRows* J, int count, Scalar* X, int ld, Scalar* S,
                    int lds) {
  if (count == 0) return;
  gather_many(P, J, count, X, ld);
  int new_rows = 0;
  for (int i = 0; i < count; ++i) new_rows += J[i].rows;
  project(X, new_rows, ld, J, count, S, lds);

  NewRows rows = {block, J, count, X, ld, S, lds, {}};
  rows.list_runs();
  const int last = round_up(P.n, kGroup) - 1;
  int kept = block[0].first;
  int r = 0;
  for (int i = 0; i < count; ++i) {
    for (int a = 0; a < J[i].rows; ++a, ++r, ++kept) {
      rows.new_row(i, a, r, row_of(P, kept));
      clear_behind(P, kept, kept + 1);
    }
    const int end = i + 1 < count ? block[i + 1].first : P.n;
    for (int x = block[i].first + block[i].size; x < end; ++x, ++kept) {
      rows.old_row(row_of(P, x), x, i + 1, kept < x && x < last, row_of(P, kept));
      clear_behind(P, kept, kept + 1);
    }
  }
  P.n = kept;
}

}  // namespace
}  // namespace pf
