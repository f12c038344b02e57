#pragma once

#include "covariance/triangle.h"

namespace pf {

/// Makes room for `size` rows at row `at`: what was there and behind moves back. The new rows and columns hold zeros.
/// P.n grows by size; needs P.n + size <= P.capacity. One pass, from the last row to the first.
void open_gap(Triangle& P, int at, int size);

}  // namespace pf
