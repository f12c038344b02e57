#pragma once

#include "vision/image.h"

namespace pf {

/// Pixels around a corner that is_on_straight_edge reads in each direction.
constexpr int kStraightEdgeBorder = 8;

/// Whether what passes for a corner at (x, y) is a straight edge that sampling or noise has made ragged: seen a little coarser, with the
/// image smoothed by a binomial of 1 px, the smaller eigenvalue of the mean of g gᵀ over 11x11 pixels is below 0.02 of the larger. Such
/// a place looks the same a few pixels along the edge, and is hardly ever found again (docs/matching.md).
/// False nearer to the edge of the image than kStraightEdgeBorder.
bool is_on_straight_edge(const ImageView& image, int x, int y);

}  // namespace pf
