#pragma once

#include "covariance/kernels.h"

namespace pf {

/// Makes room for `size` rows at row `at`: what was there and behind moves back, and the rows of `count` ascending, disjoint segments
/// behind `at`, no more than `size` together, go. The new rows and columns hold zeros. P.n grows by size less what goes, and has to stay
/// within P.capacity. One pass, from the last row to the first.
void open_gap(Triangle& P, int at, int size, const Segment* gone, int count);

}  // namespace pf
