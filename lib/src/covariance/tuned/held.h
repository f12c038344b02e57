#pragma once

#include "covariance/tuned/downdate.h"

namespace pf {
namespace {

constexpr int kHeldChunk = 32;  ///< rows of W that are copied at a time

/// A group of eight columns of W, of which some may be held: W = free + held, each with zeros where the other has values.
struct SplitGroup {
  alignas(64) Scalar free[kHeldChunk * kGroup];
  alignas(64) Scalar held[kHeldChunk * kGroup];

  /// Columns j .. j + 7 of `rows` rows of W; those of [held_first, held_end) are held.
  PF_INLINE void copy(const Scalar* W, std::ptrdiff_t ld, int rows, int j, int held_first, int held_end) {
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < kGroup; ++c) {
        const bool is_held = j + c >= held_first && j + c < held_end;
        const Scalar w = W[r * ld + j + c];
        free[r * kGroup + c] = is_held ? 0 : w;
        held[r * kGroup + c] = is_held ? w : 0;
      }
    }
  }
};

/// Rows of group q, columns from j (eight):  P -= free_q^T B + held_q^T B_free - U^T G - G^T U. B has the leading dimension b_stride;
/// what is null is left out.
struct MixedSquare {
  const Scalar* free;
  std::ptrdiff_t free_stride;
  const Scalar* B;
  std::ptrdiff_t b_stride;
  const Scalar* held;
  std::ptrdiff_t held_stride;
  const Scalar* B_free;
};

PF_INLINE void downdate_square(const Triangle& P, const Thin& t, const MixedSquare& s, int q, int j) {
  const std::ptrdiff_t stride = kGroup * (q + 1);
  for_eight([&](auto v, auto count, int at) PF_LAMBDA {
#pragma GCC unroll 1
    for (int half = 0; half < kGroup; half += kTileRows) {
      Tile<decltype(v), kTileRows, decltype(count)::value> tile;
      tile.zero();
      if (s.free != nullptr) tile.accumulate(s.free + half, 1, s.free_stride, s.B + at, s.b_stride, t.m);
      if (s.held != nullptr) tile.accumulate(s.held + half, 1, s.held_stride, s.B_free + at, kGroup, t.m);
      if (t.k > 0) {
        const int i = q * kGroup + half;
        tile.template accumulate<true>(t.U + i, 1, t.ld, t.G + j + at, t.ld, t.k);
        tile.template accumulate<true>(t.G + i, 1, t.ld, t.U + j + at, t.ld, t.k);
      }
      tile.subtract_from(P.data + group_offset(q) + half * stride + j + at, stride);
    }
  });
}

/// The last columns of W up to `end`, groups of eight that are as wide as a tile, with zeros in the held ones.
struct FreeStrip {
  static constexpr int kColumns = round_up(kTileVectors * Wide::kWidth, kGroup);
  alignas(64) Scalar values[kHeldChunk * kColumns];
  int first, width;

  PF_INLINE FreeStrip(int end) : first(end > kColumns ? end - kColumns : 0), width(end - first) {}

  PF_INLINE void copy(const Scalar* W, std::ptrdiff_t ld, int rows, int held_first) {
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < width; ++c) values[r * kColumns + c] = first + c < held_first ? W[r * ld + first + c] : 0;
    }
  }
};

/// Vectors of a strip of the border: as many as its groups of eight hold whole, since it is a small part of the triangle and each width is
/// code of its own.
constexpr int kBorderVectors = kTileVectors * Wide::kWidth % kGroup == 0 || kGroup % (kTileVectors * Wide::kWidth) == 0
                                   ? kTileVectors
                                   : kGroup / Wide::kWidth;
static_assert(kBorderVectors >= 1 && kBorderVectors <= kTileVectors, "no wider than a tile");

/// Where held rows and others share groups of eight: the group c0 that the range begins in, as columns, and the group q1 that it ends
/// in, as rows. Whole groups are c0 + 1 .. q1 - 1.
///
///   group     before   c0         whole    q1
///   c0                | mixed |
///   whole   | W free_c0       |  nothing  |
///   q1                | mixed | free_q1 W | mixed |
inline void downdate_border(const Triangle& P, const Thin& all, int held_first, int held_end) {
  const int c0 = held_first / kGroup;
  const int q1 = (held_end - 1) / kGroup;
  const bool begins_whole = held_first % kGroup == 0;
  const bool ends_whole = held_end % kGroup == 0;
  SplitGroup first, last;
  FreeStrip strip((c0 + 1) * kGroup);
  for (int r0 = 0; r0 == 0 || r0 < all.m; r0 += kHeldChunk) {
    Thin t = all;
    t.W = all.W + r0 * all.ld;
    t.m = smaller(kHeldChunk, all.m - r0);
    t.k = r0 == 0 ? all.k : 0;
    first.copy(t.W, t.ld, t.m, c0 * kGroup, held_first, held_end);
    last.copy(t.W, t.ld, t.m, q1 * kGroup, held_first, held_end);
    const auto square = [&](int q, int c) {
      const SplitGroup& rows = q == c0 ? first : last;
      downdate_square(P, t,
                      {rows.free, kGroup, t.W + c * kGroup, t.ld, rows.held, kGroup, c == c0 ? first.free : last.free},
                      q, c * kGroup);
      if (c == q) clear_upper(P, q);
    };
    if (!begins_whole) {
      strip.copy(t.W, t.ld, t.m, held_first);
      for (int q = c0 + 1; q < q1 + int(ends_whole); ++q) {
        const std::ptrdiff_t stride = kGroup * (q + 1);
        Scalar* rows = P.data + group_offset(q);
        for_strips<kBorderVectors>(strip.first, strip.width, [&](auto v, auto count, int at) PF_LAMBDA {
          downdate_tile<decltype(v), decltype(count)::value>(t, {t.k, t.k}, t.W + q * kGroup, t.ld,
                                                             strip.values + at - strip.first, FreeStrip::kColumns,
                                                             rows + at, stride, q * kGroup, at);
        });
      }
    }
    if (!begins_whole || (c0 == q1 && !ends_whole)) square(c0, c0);
    if (ends_whole || c0 == q1) continue;
    if (!begins_whole) square(q1, c0);
    const int from = (c0 + int(!begins_whole)) * kGroup;
    Scalar* rows = P.data + group_offset(q1);
    for (int j = from; j < q1 * kGroup; j += FreeStrip::kColumns) {
      for_strips<kBorderVectors>(
          j, smaller(FreeStrip::kColumns, q1 * kGroup - j), [&](auto v, auto count, int at) PF_LAMBDA {
            downdate_tile<decltype(v), decltype(count)::value>(t, {t.k, t.k}, last.free, kGroup, t.W + at, t.ld,
                                                               rows + at, kGroup * (q1 + 1), q1 * kGroup, at);
          });
    }
    square(q1, q1);
  }
}

/// Twin: reference::downdate.
///
///           | before | held     | behind
///   before  |  all   |
///   held    |  all   | U, G     |            with tiles of both kinds along its border
///   behind  |  all   | all      | all
void downdate(Triangle& P, const Scalar* W, int m, const Scalar* U, const Scalar* G, int k, int ld, int held_first,
              int held_end) {
  constexpr std::ptrdiff_t kNear = (1 << 20) / sizeof(Scalar);
  const int groups = (P.n + kGroup - 1) / kGroup;
  const int columns = groups * kGroup;
  Touched touched;
  if (k > Kernels::kDenseRows) touched.find(U, k, ld, groups);
  const Thin with = {W, m, U, G, k, ld, touched.any, group_offset(groups) > kNear};
  if (held_end <= held_first) {
    downdate_part(P, with, 0, groups, 0, columns);
  } else {
    Thin without = with;
    without.m = 0;
    const int end = held_end >= P.n ? columns : held_end;
    const int q0 = held_first / kGroup;
    const int q1 = round_up(end, kGroup) / kGroup;
    const int whole = round_up(held_first, kGroup) / kGroup;
    const int whole_end = end / kGroup;
    downdate_part(P, with, 0, q0, 0, columns);
    if (whole > q0 && whole < whole_end) {  // the border takes the last columns of whole groups
      downdate_part(P, with, q0, whole, 0, q0 * kGroup);
      downdate_part(P, with, whole, whole_end, 0, FreeStrip((q0 + 1) * kGroup).first);
      downdate_part(P, with, whole_end, q1, 0, q0 * kGroup);
    } else {
      downdate_part(P, with, q0, q1, 0, q0 * kGroup);
    }
    if (held_first % kGroup != 0 || end % kGroup != 0) downdate_border(P, with, held_first, end);
    downdate_part(P, without, whole, whole_end, whole * kGroup, whole_end * kGroup);
    downdate_part(P, with, q1, groups, 0, columns);
  }
}

}  // namespace
}  // namespace pf
