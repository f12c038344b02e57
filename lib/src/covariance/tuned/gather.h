#pragma once

#include "covariance/tuned/tile.h"

namespace pf {
namespace {

/// Columns that a gather works on at a time.
constexpr int kStrip = 512 / static_cast<int>(sizeof(Scalar));

/// What panel are filled from: rows of a symmetric matrix, or columns of a thin one.
struct FromTriangle {
  const Triangle& P;
};
struct FromThin {
  const Scalar* X;
  int rows;
  std::ptrdiff_t ld;
};

/// Rows c of the symmetric matrix, columns j0 .. j0 + columns - 1 (multiples of eight), for the `size` rows c from `first`; zero
/// from column n on.
///
///   j  | up to the row's own             | from the group of first on
///      | rows as they are stored, last   | columns of the triangle, transposed, first
///
/// The panel has room for a multiple of four rows, which transposing fills with what follows in the same rows of the triangle: of
/// the last group's last row, that may lie behind the matrix.
inline void fill_panel(FromTriangle source, int first, int size, int j0, int columns, Scalar* panel) {
  const Triangle& P = source.P;
  const int end = j0 + columns;
  const int square = first / kGroup * kGroup;
  const int all = round_up(P.n, kGroup);
  const int transposed = first + round_up(size, 4) > all ? all - kGroup : all;
  for (int j = j0 > square ? j0 : square; j < smaller(end, transposed); j += kGroup) {
    const std::ptrdiff_t stride = j + kGroup;
    const Scalar* group = P.data + group_offset(j / kGroup) + first;
    Scalar* to = panel + (j - j0);
    for (int r = 0; r < kGroup; r += Narrow::kWidth) {
      for (int c = 0; c < size; c += 4) {
        Narrow::Type column[4];
        load_columns<Narrow>(group + r * stride + c, stride, column);
#pragma GCC unroll 4
        for (int i = 0; i < 4; ++i) Narrow::store(to + (c + i) * kStrip + r, column[i]);
      }
    }
  }
  for (int j = j0 > transposed ? j0 : transposed; j < smaller(end, P.n); ++j) {
    for (int c = 0; c < size; ++c) panel[c * kStrip + j - j0] = row_of(P, j)[first + c];
  }
  if (j0 < first + size) {
    const int before = smaller(end, square);
    for (int c = 0; c < size; ++c) {
      const Scalar* row = row_of(P, first + c);
      Scalar* to = panel + c * kStrip - j0;
      copy_groups(to + j0, row + j0, before - j0);
      for (int j = j0 > square ? j0 : square; j < smaller(end, first + c + 1); ++j) {
        to[j] = row[j];
        asm("" ::: "memory");  // keeps the compiler from making a call of it
      }
    }
  }
  for (int j = P.n; j < end; ++j) {
    for (int c = 0; c < size; ++c) panel[c * kStrip + j - j0] = 0;
  }
}

/// Columns c of X for its rows a0 .. a0 + count - 1, transposed; zero from row `rows` on.
inline void fill_panel(FromThin source, int first, int size, int a0, int count, Scalar* panel) {
  const Scalar* X = source.X + a0 * source.ld + first;
  const int rows = smaller(count, source.rows - a0);
  const bool wide = first + round_up(size, 4) <= source.ld;
  const int whole = wide ? rows / 4 * 4 : 0;
  for (int a = 0; a < whole; a += 4) {
    for (int c = 0; c < size; c += 4) {
      transpose_four(X + a * source.ld + c, source.ld, panel + c * kStrip + a, kStrip);
    }
  }
  for (int c = 0; c < size; ++c) {
    for (int a = whole; a < rows; ++a) panel[c * kStrip + a] = X[a * source.ld + c];
    for (int a = rows; a < count; ++a) panel[c * kStrip + a] = 0;
  }
}

/// The operand of J for the strip at hand: a row per touched column, in J's order, so that one loop runs over all of them.
///
///   values  | body | plane | point |      Jacobians that begin with the same segments share them: only the rest is filled again
struct Panel {
  // Transposing writes up to three rows too many.
  alignas(64) Scalar values[(SparseRows::kMaxColumns + 3) * kStrip];
  Segment segment[SparseRows::kMaxSegments];
  int segments;

  PF_INLINE void clear() { segments = 0; }

  template <class Source>
  PF_INLINE void fill(Source source, const SparseRows& J, int j0, int columns) {
    Scalar* to = values;
    bool same = true;
    for (int s = 0; s < J.segments; ++s) {
      const Segment wanted = J.segment[s];
      same = same && s < segments && segment[s].first == wanted.first && segment[s].size == wanted.size;
      if (!same) fill_panel(source, wanted.first, wanted.size, j0, columns, to);
      segment[s] = wanted;
      to += wanted.size * kStrip;
    }
    segments = J.segments;
  }
};

/// J times its operand, columns first .. columns - 1 (multiples of eight), into out (leading dimension ld), two rows at a time.
inline void multiply_panel(const SparseRows& J, const Panel& panel, int first, int columns, Scalar* out,
                           std::ptrdiff_t ld) {
  constexpr int kMost = kTileRows * kTileVectors >= 16 ? 8 : 4;
  const int width = columns_of(J);
  for (int a = 0; a < J.rows; a += 2) {
    for_strips<kMost>(first, columns - first, [&](auto v, auto count, int j) PF_LAMBDA {
      if (a + 1 < J.rows) {
        Tile<decltype(v), 2, decltype(count)::value> tile;
        tile.zero();
        tile.accumulate(J.h + a * width, width, 1, panel.values + j, kStrip, width);
        tile.store(out + a * ld + j, ld);
      } else {
        Tile<decltype(v), 1, decltype(count)::value> tile;
        tile.zero();
        tile.accumulate(J.h + a * width, width, 1, panel.values + j, kStrip, width);
        tile.store(out + a * ld + j, ld);
      }
    });
  }
}

/// Twin: reference::gather_many.
void gather_many(const Triangle& P, const SparseRows* J, int count, Scalar* out, int ld) {
  Panel panel;
  const int all = round_up(P.n, kGroup);
  for (int j0 = 0; j0 < all; j0 += kStrip) {
    panel.clear();
    Scalar* to = out + j0;
    const int columns = smaller(kStrip, all - j0);
    for (int i = 0; i < count; ++i) {
      panel.fill(FromTriangle{P}, J[i], j0, columns);
      multiply_panel(J[i], panel, 0, columns, to, ld);
      to += static_cast<std::ptrdiff_t>(J[i].rows) * ld;
    }
  }
}

void gather(const Triangle& P, const SparseRows& J, Scalar* out, int ld) { gather_many(P, &J, 1, out, ld); }

/// Twin: reference::project. Rows of X are the strip's columns, so eight or more of them go at a time; of the result, J X^T, the
/// part on and below the diagonal of S is turned round and kept.
void project(const Scalar* X, int m, int ld, const SparseRows* J, int count, Scalar* S, int lds) {
  Panel panel;
  alignas(64) Scalar strip[SparseRows::kMaxRows * kStrip];
  for (int a0 = 0; a0 < m; a0 += kStrip) {
    const int end = smaller(a0 + kStrip, m);
    panel.clear();
    for (int i = 0, b0 = 0; i < count && b0 < end; b0 += J[i++].rows) {
      const int first = b0 > a0 ? (b0 - a0) / kGroup * kGroup : 0;
      const int rows = round_up(end - a0, kGroup);
      panel.fill(FromThin{X, m, ld}, J[i], a0, rows);
      multiply_panel(J[i], panel, first, rows, strip, kStrip);
      for (int r = 0; r < J[i].rows; ++r) {
        const int b = b0 + r;
        for (int a = b > a0 ? b : a0; a < end; ++a) {
          S[static_cast<std::ptrdiff_t>(a) * lds + b] = strip[r * kStrip + a - a0];
        }
      }
    }
  }
}

/// out (J.rows x J.rows, leading dimension kMaxRows) = J P J^T
///
/// Neither this nor who has a panel is inlined, since both, 20 and 31 KiB, would lie on the stack together.
__attribute__((noinline)) void square(const Triangle& P, const SparseRows& J, Scalar* out) {
  constexpr int kMaxColumns = SparseRows::kMaxColumns;
  const int width = columns_of(J);
  int at[kMaxColumns];
  for (int s = 0, c = 0; s < J.segments; ++s) {
    for (int i = 0; i < J.segment[s].size; ++i) at[c++] = J.segment[s].first + i;
  }
  Scalar block[kMaxColumns * kMaxColumns];
  for (int c = 0; c < width; ++c) {
    for (int d = 0; d <= c; ++d) {
      block[c * kMaxColumns + d] = block[d * kMaxColumns + c] = element(P, at[c], at[d]);
    }
  }
  for (int a = 0; a < J.rows; ++a) {
    Scalar product[kMaxColumns] = {};
    for (int c = 0; c < width; ++c) {
      for (int d = 0; d < width; ++d) product[d] += J.h[a * width + c] * block[c * kMaxColumns + d];
    }
    for (int b = 0; b < J.rows; ++b) {
      Scalar sum = 0;
      for (int d = 0; d < width; ++d) sum += product[d] * J.h[b * width + d];
      out[a * SparseRows::kMaxRows + b] = sum;
    }
  }
}

}  // namespace
}  // namespace pf
