#pragma once

#include "base/scalar.h"

/// The ratio that most of several have in common.

namespace pf {

struct CommonRatio {
  Scalar ratio = 0;  ///< their median; 0: there are none
  int votes = 0;     ///< how many are within a factor `width` of each other
  int others = 0;    ///< most of the remaining ones that are
};

/// ratios are positive, and are sorted.
CommonRatio find_common_ratio(Scalar* ratios, int count, Scalar width);

}  // namespace pf
