#pragma once

#include "covariance/tuned/tile.h"

namespace pf {
namespace {

/// Columns that a gather works on at a time.
constexpr int kStrip = 256 / static_cast<int>(sizeof(Scalar));

/// Row c of the symmetric matrix, columns j0 .. j0 + kStrip - 1, for the `size` rows c from `first`; zero from column n on.
/// Left of the diagonal a row is contiguous; below it, the rows of the triangle are read across and stored transposed.
inline void fill_panel(const Triangle& P, int first, int size, int j0, Scalar* panel) {
  const int end = smaller(P.n, j0 + kStrip);
  for (int c = 0; c < size; ++c) {
    Scalar* to = panel + c * kStrip;
    const Scalar* row = row_of(P, first + c);
    const int left = smaller(end, first + c + 1);
    for (int j = j0; j < left; ++j) to[j - j0] = row[j];
    for (int j = end; j < j0 + kStrip; ++j) to[j - j0] = 0;
  }
  for (int j = j0 > first ? j0 : first; j < end; ++j) {
    const Scalar* row = row_of(P, j) + first;
    const int above = smaller(size, j - first);
    Scalar* to = panel + (j - j0);
    for (int c = 0; c < above; ++c) to[c * kStrip] = row[c];
  }
}

/// Panels of the strip at hand, kept while there is room, so that what Jacobians share is read once.
struct Panels {
  static constexpr int kColumns = 64;
  static constexpr int kSegments = 16;

  Scalar values[kColumns * kStrip];
  Segment segment[kSegments];
  int begin[kSegments];
  int segments;
  int columns;

  PF_INLINE void clear() { segments = columns = 0; }

  /// Make room for one Jacobian; every segment of it then stays until the next call.
  PF_INLINE void reserve(int more_segments, int more_columns) {
    if (segments + more_segments > kSegments || columns + more_columns > kColumns) clear();
  }

  PF_INLINE const Scalar* find(const Triangle& P, Segment wanted, int j0) {
    for (int s = 0; s < segments; ++s) {
      if (segment[s].first == wanted.first && segment[s].size == wanted.size) {
        return values + begin[s] * kStrip;
      }
    }
    Scalar* panel = values + columns * kStrip;
    fill_panel(P, wanted.first, wanted.size, j0, panel);
    segment[segments] = wanted;
    begin[segments++] = columns;
    columns += wanted.size;
    return panel;
  }
};

/// (J P)(:, j0 .. j0 + kStrip - 1) into out (leading dimension ld), `columns` of it, a multiple of eight.
inline void gather_strip(const Triangle& P, const SparseRows& J, Panels& panels, int j0, int columns,
                         Scalar* out, std::ptrdiff_t ld) {
  const int width = columns_of(J);
  const Scalar* operand[SparseRows::kMaxSegments];
  panels.reserve(J.segments, width);
  for (int s = 0; s < J.segments; ++s) operand[s] = panels.find(P, J.segment[s], j0);
  for_strips(columns, [&](auto v, auto count, int j) {
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
      gather_strip(P, J[i], panels, j0, smaller(kStrip, all - j0), to, ld);
      to += static_cast<std::ptrdiff_t>(J[i].rows) * ld;
    }
  }
}

void gather(const Triangle& P, const SparseRows& J, Scalar* out, int ld) {
  gather_many(P, &J, 1, out, ld);
}

/// out (J.rows x J.rows, leading dimension kMaxRows) = J P J^T
inline void project(const Triangle& P, const SparseRows& J, Scalar* out) {
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
