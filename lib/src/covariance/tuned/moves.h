#pragma once

#include "covariance/tuned/gather.h"

namespace pf {
namespace {

constexpr int kMaxRows = SparseRows::kMaxRows;

/// Zero what is stored behind column `from` in row i.
PF_INLINE void clear_behind(const Triangle& P, int i, int from) {
  Scalar* row = row_of(P, i);
  for (int j = from; j < stride_of(i); ++j) row[j] = 0;
}

/// J P, strip by strip, into the rows behind those that there are.
__attribute__((noinline)) void append_rows(const Triangle& P, const SparseRows& J) {
  const int n = P.n;
  Panel panel;
  Scalar strip[kMaxRows * kStrip];
  for (int j0 = 0; j0 < n; j0 += kStrip) {
    const int columns = smaller(kStrip, n - j0);
    panel.clear();
    panel.fill(FromTriangle{P}, J, j0, round_up(columns, kGroup));
    multiply_panel(J, panel, 0, round_up(columns, kGroup), strip, kStrip);
    for (int a = 0; a < J.rows; ++a) {
      copy_groups(row_of(P, n + a) + j0, strip + a * kStrip, round_up(columns, kGroup));
    }
  }
}

/// Twin: reference::augment. New rows are gathered strip by strip and copied to where they belong; a new group starts clean.
void augment(Triangle& P, const SparseRows& J, const Scalar* noise) {
  const int n = P.n;
  Scalar JPJ[kMaxRows * kMaxRows];
  square(P, J, JPJ);
  append_rows(P, J);
  for (int a = 0; a < J.rows; ++a) {
    Scalar* row = row_of(P, n + a) + n;
    for (int b = 0; b <= a; ++b) row[b] = JPJ[a * kMaxRows + b] + noise[a * J.rows + b];
    clear_behind(P, n + a, n + a + 1);
  }
  P.n = n + J.rows;
  for (int i = P.n; i % kGroup != 0; ++i) clear_behind(P, i, 0);
}

/// J P, strip by strip, into the rows and columns of a block, but for the block with itself.
__attribute__((noinline)) void replace_rows(const Triangle& P, int first, int size, const SparseRows& J) {
  Panel panel;
  Scalar strip[kMaxRows * kStrip];
  for (int j0 = 0; j0 < P.n; j0 += kStrip) {
    const int end = smaller(j0 + kStrip, P.n);
    panel.clear();
    panel.fill(FromTriangle{P}, J, j0, round_up(end - j0, kGroup));
    multiply_panel(J, panel, 0, round_up(end - j0, kGroup), strip, kStrip);
    for (int a = 0; a < J.rows; ++a) {
      Scalar* row = row_of(P, first + a);
      for (int j = j0; j < smaller(end, first); ++j) row[j] = strip[a * kStrip + j - j0];
    }
    int j = j0 > first + size ? j0 : first + size;
    while (j < end) {
      const std::ptrdiff_t stride = stride_of(j);
      const int group_end = smaller(end, j / kGroup * kGroup + kGroup);
      for (Scalar* row = row_of(P, j) + first; j < group_end; ++j, row += stride) {
        for (int a = 0; a < J.rows; ++a) row[a] = strip[a * kStrip + j - j0];
      }
    }
  }
}

/// Twin: reference::replace. A row outside of the block takes its new entries from its own old ones alone, so strips may go one
/// after the other in place; the block with itself is formed before anything moves.
void replace(Triangle& P, int first, int size, const SparseRows& J, const Scalar* noise) {
  Scalar JPJ[kMaxRows * kMaxRows];
  square(P, J, JPJ);
  replace_rows(P, first, size, J);
  for (int a = 0; a < J.rows; ++a) {
    Scalar* row = row_of(P, first + a) + first;
    for (int b = 0; b <= a; ++b) {
      row[b] = JPJ[a * kMaxRows + b] + (noise != nullptr ? noise[a * J.rows + b] : 0);
    }
  }
}

/// Twin: reference::remove. Rows and runs of columns only ever move towards the front, and a row that moves lands at least one
/// row's length before where it was. So one pass in place is enough, and runs may be copied in whole eights: what is written too
/// much lies before all that is still to be read, and is overwritten by the next run or row. Only the last row of the last group
/// is copied to the element, since nothing is stored behind it.
void remove(Triangle& P, const Segment* gone, int count) {
  const int last = round_up(P.n, kGroup) - 1;
  int kept = count > 0 ? gone[0].first : P.n;
  for (int s = 0; s < count; ++s) {
    const int begin = gone[s].first + gone[s].size;
    const int end = s + 1 < count ? gone[s + 1].first : P.n;
    for (int i = begin; i < end; ++i, ++kept) {
      const Scalar* from = row_of(P, i);
      Scalar* row = row_of(P, kept);
      int to = 0;
      int run = 0;
      for (int g = 0; g <= s + 1; ++g) {
        const int size = (g <= s ? gone[g].first : i + 1) - run;
        if (i < last) {
          copy_groups(row + to, from + run, size);
        } else {
          for (int j = 0; j < size; ++j) row[to + j] = from[run + j];
        }
        to += size;
        if (g <= s) run = gone[g].first + gone[g].size;
      }
      clear_behind(P, kept, kept + 1);
    }
  }
  P.n = kept;
}

void transform(Triangle& P, int first, int size, const SparseRows& J, const Scalar* noise) {
  replace(P, first, size, J, noise);
  const Segment gap = {first + J.rows, size - J.rows};
  if (gap.size > 0) remove(P, &gap, 1);
}

}  // namespace
}  // namespace pf
