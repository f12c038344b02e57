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

/// Twin: reference::augment. New rows are gathered strip by strip and copied to where they belong; a new group starts clean.
void augment(Triangle& P, const SparseRows& J, const Scalar* noise) {
  const int n = P.n;
  Scalar JPJ[kMaxRows * kMaxRows];
  square(P, J, JPJ);

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
  for (int a = 0; a < J.rows; ++a) {
    Scalar* row = row_of(P, n + a) + n;
    for (int b = 0; b <= a; ++b) row[b] = JPJ[a * kMaxRows + b] + noise[a * J.rows + b];
    clear_behind(P, n + a, n + a + 1);
  }
  P.n = n + J.rows;
  for (int i = P.n; i % kGroup != 0; ++i) clear_behind(P, i, 0);
}

/// Twin: reference::replace. A row outside of the block takes its new entries from its own old ones alone, so strips may go one
/// after the other in place; the block with itself is formed before anything moves.
void replace(Triangle& P, int first, int size, const SparseRows& J, const Scalar* noise) {
  Scalar JPJ[kMaxRows * kMaxRows];
  square(P, J, JPJ);

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
    for (int j = j0 > first + size ? j0 : first + size; j < end; ++j) {
      Scalar* row = row_of(P, j) + first;
      for (int a = 0; a < J.rows; ++a) row[a] = strip[a * kStrip + j - j0];
    }
  }
  for (int a = 0; a < J.rows; ++a) {
    Scalar* row = row_of(P, first + a) + first;
    for (int b = 0; b <= a; ++b) {
      row[b] = JPJ[a * kMaxRows + b] + (noise != nullptr ? noise[a * J.rows + b] : 0);
    }
  }
}

/// to <- from for to <= from, front to back; the two may overlap.
PF_INLINE void move_down(Scalar* to, const Scalar* from, int count) {
  int j = 0;
  for (; j + Wide::kWidth <= count; j += Wide::kWidth) Wide::store(to + j, Wide::load(from + j));
#pragma GCC unroll 1
  for (; j < count; ++j) {
    to[j] = from[j];
    asm("" ::: "memory");  // stays a loop: a library call for a handful of scalars costs more
  }
}

/// Twin: reference::remove. Rows and runs of columns only ever move towards the front, so one pass in place is enough.
void remove(Triangle& P, const Segment* gone, int count) {
  int kept = count > 0 ? gone[0].first : P.n;
  for (int s = 0; s < count; ++s) {
    const int begin = gone[s].first + gone[s].size;
    const int end = s + 1 < count ? gone[s + 1].first : P.n;
    for (int i = begin; i < end; ++i, ++kept) {
      const Scalar* from = row_of(P, i);
      Scalar* row = row_of(P, kept);
      int to = 0;
      int run = 0;
      for (int g = 0; g <= s; ++g) {
        move_down(row + to, from + run, gone[g].first - run);
        to += gone[g].first - run;
        run = gone[g].first + gone[g].size;
      }
      move_down(row + to, from + run, i + 1 - run);
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
