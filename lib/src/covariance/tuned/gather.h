#pragma once

#include "covariance/tuned/tile.h"

namespace pf {
namespace {

/// Columns that a gather works on at a time.
constexpr int kStrip = 512 / static_cast<int>(sizeof(Scalar));

/// What panels are filled from: rows of a symmetric matrix, or columns of a thin one.
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
///   j  | before the group of first | up to that of the last row | behind
///      | rows as they are stored   | element by element         | columns of the triangle, transposed
///
/// The panel has room for a multiple of four rows, which transposing fills with what follows in the same rows of the triangle.
inline void fill_panel(FromTriangle source, int first, int size, int j0, int columns, Scalar* panel) {
  const Triangle& P = source.P;
  const int end = j0 + columns;
  const int left = smaller(end, first / kGroup * kGroup);
  const int right = smaller(end, round_up(first + size, kGroup));
  for (int c = 0; c < size; ++c) {
    const Scalar* row = row_of(P, first + c);
    Scalar* to = panel + c * kStrip - j0;
    for (int j = j0; j < left; j += Narrow::kWidth) Narrow::store(to + j, Narrow::load(row + j));
    for (int j = j0 > left ? j0 : left; j < right; j += kGroup) {
      const Scalar* column = P.data + group_offset(j / kGroup) + first + c;
      for (int i = 0; i < kGroup; ++i) {
        to[j + i] = j + i <= first + c ? row[j + i] : column[i * (j + kGroup)];
      }
    }
  }
  for (int j = j0 > right ? j0 : right; j < end; j += kGroup) {
    const std::ptrdiff_t stride = j + kGroup;
    const Scalar* group = P.data + group_offset(j / kGroup) + first;
    Scalar* to = panel + (j - j0);
    for (int c = 0; c < size; c += 4) {
      transpose_four(group + c, stride, to + c * kStrip, kStrip);
      transpose_four(group + 4 * stride + c, stride, to + c * kStrip + 4, kStrip);
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

/// Panels of the strip at hand, kept while there is room, so that what Jacobians share is read once. The first one (the body, as a
/// rule) stays.
struct Panels {
  static constexpr int kColumns = 56;
  static constexpr int kSegments = 16;

  alignas(64) Scalar values[kColumns * kStrip];
  Segment segment[kSegments];
  int begin[kSegments + 1];
  int count;

  PF_INLINE void clear() { count = begin[0] = 0; }

  /// Make room for one Jacobian; every segment of it then stays until the next call.
  PF_INLINE void reserve(const SparseRows& J) {
    int more = 0;
    for (int s = 0; s < J.segments; ++s) more += round_up(J.segment[s].size, 4);
    if (count + J.segments <= kSegments && begin[count] + more <= kColumns) return;
    count = count > 0 && begin[1] + more <= kColumns ? 1 : 0;
  }

  template <class Source>
  PF_INLINE const Scalar* find(Source source, Segment wanted, int j0, int columns) {
    int s = 0;
    while (s < count && (segment[s].first != wanted.first || segment[s].size != wanted.size)) ++s;
    if (s == count) {
      segment[s] = wanted;
      begin[s + 1] = begin[s] + round_up(wanted.size, 4);
      fill_panel(source, wanted.first, wanted.size, j0, columns, values + begin[s] * kStrip);
      ++count;
    }
    return values + begin[s] * kStrip;
  }
};

/// J times the source's columns j0 .. j0 + columns - 1 (a multiple of eight) into out (leading dimension ld).
template <class Source>
inline void gather_strip(Source source, const SparseRows& J, Panels& panels, int j0, int columns,
                         Scalar* out, std::ptrdiff_t ld) {
  const int width = columns_of(J);
  const Scalar* operand[SparseRows::kMaxSegments];
  panels.reserve(J);
  for (int s = 0; s < J.segments; ++s) operand[s] = panels.find(source, J.segment[s], j0, columns);
  for_strips<4>(columns, [&](auto v, auto count, int j) {
    for_heights(J.rows, [&](auto height, int a) PF_LAMBDA {
      Tile<decltype(v), decltype(height)::value, decltype(count)::value> tile;
      tile.zero();
      const Scalar* h = J.h + a * width;
      for (int s = 0; s < J.segments; ++s) {
        tile.accumulate(h, width, 1, operand[s] + j, kStrip, J.segment[s].size);
        h += J.segment[s].size;
      }
      tile.store(out + a * ld + j, ld);
    });
  });
}

/// Twin: reference::gather_many.
void gather_many(const Triangle& P, const SparseRows* J, int count, Scalar* out, int ld) {
  Panels panels;
  const int all = round_up(P.n, kGroup);
  for (int j0 = 0; j0 < all; j0 += kStrip) {
    panels.clear();
    Scalar* to = out + j0;
    for (int i = 0; i < count; ++i) {
      gather_strip(FromTriangle{P}, J[i], panels, j0, smaller(kStrip, all - j0), to, ld);
      to += static_cast<std::ptrdiff_t>(J[i].rows) * ld;
    }
  }
}

void gather(const Triangle& P, const SparseRows& J, Scalar* out, int ld) {
  gather_many(P, &J, 1, out, ld);
}

/// Twin: reference::project. Rows of X are the strip's columns, so eight or more of them go at a time; of the result, J X^T, the
/// part on and below the diagonal of S is turned round and kept.
void project(const Scalar* X, int ld, const SparseRows* J, int count, Scalar* S, int lds) {
  int m = 0;
  for (int i = 0; i < count; ++i) m += J[i].rows;
  Panels panels;
  alignas(64) Scalar strip[SparseRows::kMaxRows * kStrip];
  for (int a0 = 0; a0 < m; a0 += kStrip) {
    const int end = smaller(a0 + kStrip, m);
    panels.clear();
    for (int i = 0, b0 = 0; i < count && b0 < end; b0 += J[i++].rows) {
      gather_strip(FromThin{X, m, ld}, J[i], panels, a0, round_up(end - a0, kGroup), strip, kStrip);
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
inline void square(const Triangle& P, const SparseRows& J, Scalar* out) {
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
