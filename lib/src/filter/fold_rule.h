#pragma once

#include <cstdint>

#include "base/scalar.h"

namespace pf {

/// Rule for folding points into a plane.
struct FoldRule {
  Scalar roughness = 0;   ///< of real surfaces: standard deviation of a point's distance from its plane [m]
  Scalar gate = 0;        ///< chi-square bound of the distance, one degree of freedom
  bool condition = true;  ///< measure the distance as zero, then drop it; else only drop it (Gee 2007, eq 4 and 6)
};

/// How a point is fixed that is known well enough in its point group.
enum class FixForm {
  kConsider,  ///< keeps its rows, without gain of its own (Schmidt)
  kInflate,   ///< loses its rows; its variance stays as noise of its pixels
  kErrorFree  ///< loses its rows and its variance (Gee 2007, section 3.4)
};

}  // namespace pf
