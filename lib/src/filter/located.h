#pragma once

#include "filter/block_filter.h"

namespace pf {

/// Rows with the segments of the state that their parts are, as the kernels read them.
struct BlockFilter::Located {
  Segment segment[SparseRows::kMaxSegments];
  SparseRows rows;
};

inline void BlockFilter::locate(const Rows& J, Located* out) const {
  PF_ASSERT(J.rows <= SparseRows::kMaxRows && J.parts <= SparseRows::kMaxSegments);
  for (int p = 0; p < J.parts; ++p) out->segment[p] = {row(J.part[p]), J.part[p].size};
  out->rows = {J.rows, J.parts, out->segment, J.h};
}

}  // namespace pf
